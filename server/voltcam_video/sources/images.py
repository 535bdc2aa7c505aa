"""A folder of images with a list of their times: the Event Camera Dataset's layout.

images.txt has a line `seconds filename` per image, names relative to the folder
(Mueggler et al., "The Event-Camera Dataset and Simulator", IJRR 2017).
"""

import threading
from collections.abc import Iterator
from decimal import Decimal, InvalidOperation
from pathlib import Path

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, Image, luminance
from voltcam_video.opencv import cv2
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError

LIST = "images.txt"


class ImagesSource(RecordedSource):
    """The listed images, in the list's order and at its times."""

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._folder = Path(request.uri)
        self._entries = _read_list(self._folder)
        height, width = _read_image(self._folder / self._entries[0][1]).shape
        span_us = self._entries[-1][0] - self._entries[0][0]
        self.granted = Granted(
            kind="images",
            live=False,
            width=width,
            height=height,
            fps=(len(self._entries) - 1) * 1e6 / span_us if span_us else None,
            pixel_format=None,
            frames=len(self._entries),
            backend=None,
            clock="recording",
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.path is not None and request.path.is_dir()

    def _take(self) -> Iterator[Frame]:
        for t_us, name in self._entries:
            yield Frame(_read_image(self._folder / name), t_us)


def _read_list(folder: Path) -> list[tuple[int, str]]:
    """Times and names, checked. Raises SourceError naming the line."""
    path = folder / LIST
    try:
        lines = path.read_text().splitlines()
    except FileNotFoundError:
        raise SourceError(
            f"{folder}: no {LIST} in this folder; images need their times: a line 'seconds filename' for each"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise SourceError(f"{path}: cannot be read: {error}") from None
    entries: list[tuple[int, str]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        t_us, name = _parse(line, f"{path}, line {number}")
        if entries and t_us <= entries[-1][0]:
            raise SourceError(
                f"{path}, line {number}: {t_us} us is not later than the line before ({entries[-1][0]} us); "
                "sort the list by time and remove repeated lines"
            )
        if not (folder / name).resolve().is_relative_to(folder.resolve()):
            raise SourceError(f"{path}, line {number}: the image is outside of the folder; copy it there")
        if not (folder / name).is_file():
            raise SourceError(f"{path}, line {number}: no such image; copy it or remove the line")
        entries.append((t_us, name))
    if not entries:
        raise SourceError(f"{path}: lists no image; write a line 'seconds filename' for each")
    return entries


def _parse(line: str, where: str) -> tuple[int, str]:
    seconds, _, name = line.strip().partition(" ")
    try:
        # Decimal, because epoch seconds with nanoseconds do not fit a float.
        return round(Decimal(seconds) * 1_000_000), name.strip()
    except (InvalidOperation, ValueError, OverflowError):
        raise SourceError(f"{where}: not 'seconds filename'; correct the line") from None


def _read_image(path: Path) -> Image:
    image = cv2.imread(str(path), cv2.IMREAD_ANYCOLOR | cv2.IMREAD_ANYDEPTH)
    if image is None:
        raise SourceError(f"{path}: not an image OpenCV can read; replace it or remove its line from {LIST}")
    return luminance(image)
