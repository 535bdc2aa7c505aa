"""Results of long campaigns: a line of JSON each, on disk as soon as it is known."""

import hashlib
import os
from functools import cache
from modulefinder import ModuleFinder
from pathlib import Path

_TESTS = Path(__file__).parent
_OURS = [_TESTS.parent / folder for folder in ("simulator", "server/voltcam_video")]


def whole_lines(file: Path) -> list[bytes]:
    """The lines of a results file. One that was cut off while it was written is removed from it."""
    if not file.exists():
        return []
    raw = file.read_bytes()
    whole = raw[: raw.rfind(b"\n") + 1]
    if whole != raw:
        os.truncate(file, len(whole))
    return whole.splitlines()


@cache
def digest(module: str) -> str:
    """Of the sources that results of a campaign depend on: what of simulator, lab and light between frames
    its module imports, directly or not, and the generator."""
    found = hashlib.sha256()
    for source in sources(module):
        found.update(source.read_bytes())
    return found.hexdigest()[:12]


def sources(module: str) -> list[Path]:
    """Those files, sorted. module: such as tests.hidden_effects.run."""
    finder = ModuleFinder(
        path=[str(_TESTS), *(str(_TESTS.parent / folder) for folder in ("simulator", "server"))]
    )
    finder.import_hook(module.removeprefix("tests."))  # a folder without __init__.py, which it does not know
    imported = {Path(one.__file__) for one in finder.modules.values() if one.__file__}
    ours = {file for file in imported if any(file.is_relative_to(folder) for folder in _OURS)}
    return sorted(ours | {*(_TESTS / "generator").rglob("*.py")})
