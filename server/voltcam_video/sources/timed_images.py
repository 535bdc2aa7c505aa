"""Images of a folder that has no list of its own: at an even rate, or at the times of a file beside them."""

import re
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Literal

from voltcam_client.formats.image_list import ListedImage
from voltcam_video.sources.source import SourceError

Unit = Literal["s", "ms", "us", "ns"]
MICROSECONDS: dict[str, Decimal] = {
    "s": Decimal(1_000_000),
    "ms": Decimal(1_000),
    "us": Decimal(1),
    "ns": Decimal("0.001"),
}
SUFFIXES = frozenset((".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp", ".exr"))


def images_in(folder: Path) -> list[Path]:
    """Its images, by name, numbers in it as numbers: 2.png comes before 10.png. Raises SourceError."""
    try:
        found = [path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES]
    except OSError as error:
        raise SourceError(f"{folder}: cannot be read: {error.strerror}") from None
    if not found:
        raise SourceError(f"{folder}: has no image ({', '.join(sorted(SUFFIXES))}): fill it, or leave it out")
    return sorted(found, key=_natural)


def evenly_timed(folder: Path, fps: float) -> list[ListedImage]:
    """The folder's images at `fps` a second, from time 0. Raises SourceError."""
    return [
        ListedImage(number, round((number - 1) * 1e6 / fps), path)
        for number, path in enumerate(images_in(folder), start=1)
    ]


def timed_by(folder: Path, stamps: Path, unit: Unit) -> list[ListedImage]:
    """The folder's images at the times of a text file: the first number of each line, in `unit`; lines that
    begin with # are comments. Raises SourceError, naming the line."""
    try:
        lines = stamps.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise SourceError(f"{stamps}: cannot be read ({error}): give a number a line") from None
    images, listed = images_in(folder), list[ListedImage]()
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            t_us = round(Decimal(line.replace(",", " ").split()[0]) * MICROSECONDS[unit])
        except (InvalidOperation, ValueError, OverflowError, IndexError):
            raise SourceError(f"{stamps}, line {number}: begins with no number; correct the line") from None
        if listed and t_us <= listed[-1].t_us:
            raise SourceError(f"{stamps}, line {number}: not later than the line before; sort it by time")
        if len(listed) < len(images):
            listed.append(ListedImage(number, t_us, images[len(listed)]))
        else:
            raise SourceError(f"{stamps}: has more times than {folder} has images ({len(images)})")
    if len(listed) < len(images):
        raise SourceError(f"{stamps}: has {len(listed)} times for {len(images)} images: give one for each")
    return listed


def _natural(path: Path) -> list[tuple[int, int, str]]:
    parts = re.split(r"(\d+)", path.name)
    return [(0, int(part), part) if part.isdecimal() else (1, 0, part) for part in parts]
