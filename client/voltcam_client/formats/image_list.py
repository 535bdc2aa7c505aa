"""`images.txt`: a line `seconds filename` for each image, names relative to the list.

Source: Mueggler et al., The Event-Camera Dataset and Simulator, IJRR 2017.
"""

from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

from voltcam_client.formats.recording import FormatError

IMAGE_LIST = "images.txt"


@dataclass(frozen=True)
class ListedImage:
    """line: of the list, from 1. path: in the list's folder; whether there is an image was not looked at."""

    line: int
    t_us: int
    path: Path


def read_image_list(path: Path) -> list[ListedImage]:
    """The images in the list's order; lines that begin with # are comments.

    Raises FormatError naming the line that is wrong or leads out of the folder; OSError and
    UnicodeDecodeError where the list cannot be read.
    """
    folder = path.parent.resolve()
    listed: list[ListedImage] = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            stamp, name = line.split(maxsplit=1)
            # Decimal, because epoch seconds with nanoseconds do not fit a float.
            t_us = round(Decimal(stamp) * 1_000_000)
        except (InvalidOperation, ValueError, OverflowError):
            raise FormatError(f"{path}, line {number}: not 'seconds filename'; correct the line") from None
        image = path.parent / name.strip()
        if not image.resolve().is_relative_to(folder):
            raise FormatError(f"{path}, line {number}: the image is outside of the folder: copy it there")
        listed.append(ListedImage(number, t_us, image))
    return listed
