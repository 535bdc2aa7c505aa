"""A folder of photographs."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from voltcam_video.opencv import cv2

Photograph = NDArray[Any]

SUFFIXES = (".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp")


class UnreadablePhotographError(ValueError):
    """One line: the photograph, and the remedy."""


class PhotoFolder(Sequence[Photograph]):
    """The photographs in a folder, by name; one is read when it is looked at.

    Raises ValueError where there is none, UnreadablePhotographError from looking at a damaged one.
    """

    def __init__(self, folder: Path | str) -> None:
        folder = Path(folder)
        if not folder.is_dir():
            raise ValueError(f"{folder}: no such folder; check the path")
        self.paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
        if not self.paths:
            raise ValueError(f"{folder}: no photograph in this folder; put some there ({_listed(SUFFIXES)})")

    def __len__(self) -> int:
        return len(self.paths)

    @overload
    def __getitem__(self, index: int) -> Photograph: ...
    @overload
    def __getitem__(self, index: slice) -> list[Photograph]: ...
    def __getitem__(self, index: int | slice) -> Photograph | list[Photograph]:
        if isinstance(index, slice):
            return [_read(path) for path in self.paths[index]]
        return _read(self.paths[index])


def _read(path: Path) -> Photograph:
    try:
        coded = np.frombuffer(path.read_bytes(), np.uint8)
        image = cv2.imdecode(coded, cv2.IMREAD_ANYCOLOR | cv2.IMREAD_ANYDEPTH) if coded.size else None
    except (OSError, cv2.error):
        image = None
    if image is None or image.dtype not in (np.uint8, np.uint16):
        raise UnreadablePhotographError(f"{path}: no photograph OpenCV can read; replace it or take it away")
    return image


def _listed(suffixes: Iterable[str]) -> str:
    return ", ".join(suffixes)
