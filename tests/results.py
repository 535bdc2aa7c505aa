"""Results of long campaigns: a line of JSON each, on disk as soon as it is known."""

import hashlib
import os
from pathlib import Path

import voltcam_lab
import voltcam_video

_SOURCES = (
    Path(voltcam_lab.__file__).parents[1],
    Path(voltcam_video.__file__).parent,
    Path(__file__).parent / "generator",
)


def whole_lines(file: Path) -> list[bytes]:
    """The lines of a results file. One that was cut off while it was written is removed from it."""
    if not file.exists():
        return []
    raw = file.read_bytes()
    whole = raw[: raw.rfind(b"\n") + 1]
    if whole != raw:
        os.truncate(file, len(whole))
    return whole.splitlines()


def digest() -> str:
    """Of the sources that results depend on: simulator, lab, light between frames and generator."""
    found = hashlib.sha256()
    for source in sorted(path for folder in _SOURCES for path in folder.rglob("*.py")):
        found.update(source.read_bytes())
    return found.hexdigest()[:12]
