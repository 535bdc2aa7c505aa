"""Frames in an .npz: `frames` (N, H, W) or, RGB, (N, H, W, 3); `t_us` (N,)."""

import math
import threading
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, luminance
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError

HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
MOST_SWELL, SMALL_BYTES = 250, 1 << 26  # how much larger than the file its arrays may be
DAMAGED = (OSError, EOFError, ValueError, zipfile.BadZipFile, zlib.error)


class NpzSource(RecordedSource):
    """Frames of uint8, uint16 (full scale 65535) or float (0..255), read one at a time: memory stays flat."""

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._path = request.uri
        try:
            with zipfile.ZipFile(self._path) as archive:
                self._check_names(archive)
                self._check_sizes(archive)
                with _member(archive, "frames") as file:
                    self._shape, self._dtype = self._check_frames(*_header(file))
                with _member(archive, "t_us") as file:
                    self._t_us = self._check_times(np.lib.format.read_array(file, allow_pickle=False))
        except FileNotFoundError:
            raise SourceError(f"{self._path}: no such file; check the path") from None
        except DAMAGED as error:
            raise SourceError(f"{self._path}: damaged or no .npz ({error}); write it again") from None
        self.granted = Granted(
            kind="npz",
            live=False,
            width=self._shape[2],
            height=self._shape[1],
            fps=float((len(self._t_us) - 1) * 1e6 / np.ptp(self._t_us)) if len(self._t_us) > 1 else None,
            pixel_format=str(self._dtype),
            frames=self._shape[0],
            backend=None,
            clock="recording",
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.path is not None and request.uri.endswith(".npz")

    def _check_names(self, archive: zipfile.ZipFile) -> None:
        found = {name.removesuffix(".npy") for name in archive.namelist()}
        if not {"frames", "t_us"} <= found:
            raise SourceError(
                f"{self._path}: needs frames (N, H, W) uint8 and t_us (N,) int64, "
                f"has {', '.join(sorted(found))}"
            )

    def _check_sizes(self, archive: zipfile.ZipFile) -> None:
        """Arrays are as large as they say, and what a small file can hold."""
        for name in ("frames", "t_us"):
            with _member(archive, name) as file:
                shape, _, dtype = _header(file)
            size = math.prod((dtype.itemsize, *map(int, shape)))  # of Python's numbers, which do not overflow
            most = SMALL_BYTES + MOST_SWELL * Path(self._path).stat().st_size
            if size > min(archive.getinfo(f"{name}.npy").file_size, most):
                raise SourceError(f"{self._path}: damaged: {name} is not as large as it says; write it again")

    def _check_frames(
        self, shape: tuple[int, ...], fortran: bool, dtype: np.dtype[Any]
    ) -> tuple[tuple[int, ...], np.dtype[Any]]:
        right_shape = (len(shape) == 3 or (len(shape) == 4 and shape[3] == 3)) and 0 not in shape
        right_type = dtype in (np.uint8, np.uint16) or dtype.kind == "f"
        if fortran or not (right_shape and right_type):
            order = ", Fortran order" if fortran else ""
            raise SourceError(
                f"{self._path}: frames is {shape} {dtype}{order}; it must be (N, H, W) or (N, H, W, 3), "
                "uint8, uint16 or float, C order, and not empty"
            )
        return shape, dtype

    def _check_times(self, t_us: NDArray[Any]) -> NDArray[np.int64]:
        if t_us.shape != self._shape[:1] or t_us.dtype.kind not in "iu":
            raise SourceError(
                f"{self._path}: t_us is {t_us.shape} {t_us.dtype}; it must be ({self._shape[0]},) int64, "
                "in microseconds"
            )
        t_us = t_us.astype(np.int64)
        back = np.flatnonzero(np.diff(t_us) <= 0)
        if back.size:
            i = int(back[0]) + 1
            raise SourceError(
                f"{self._path}: t_us[{i}] = {t_us[i]} is not later than t_us[{i - 1}] = {t_us[i - 1]}; "
                "sort the frames by time and remove repeated ones"
            )
        return t_us

    def _take(self) -> Iterator[Frame]:
        size = int(np.prod(self._shape[1:])) * self._dtype.itemsize
        i = 0
        try:
            with zipfile.ZipFile(self._path) as archive, _member(archive, "frames") as file:
                _header(file)
                for i, t_us in enumerate(self._t_us.tolist()):
                    pixels = file.read(size)
                    image = np.frombuffer(pixels, self._dtype).reshape(self._shape[1:])
                    self._check_values(image, i)
                    yield Frame(luminance(image[..., ::-1] if image.ndim == 3 else image), t_us)
        except DAMAGED as error:
            raise SourceError(
                f"{self._path}: damaged: {i} of {self._shape[0]} frames read ({error}); write it again"
            ) from None

    def _check_values(self, image: NDArray[Any], index: int) -> None:
        if self._dtype.kind == "f" and not (np.min(image) >= 0 and np.max(image) <= 255):
            raise SourceError(
                f"{self._path}: frames[{index}] has values outside 0..255 (or NaN); scale it to 0..255"
            )


def _member(archive: zipfile.ZipFile, name: str) -> IO[bytes]:
    return archive.open(f"{name}.npy")


def _header(file: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    version = np.lib.format.read_magic(file)
    if version not in HEADERS:
        raise ValueError(f"npy version {version}")
    return HEADERS[version](file)
