"""Frames in an .npz: `frames` (N, H, W) or, RGB, (N, H, W, 3); `t_us` (N,)."""

import threading
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats import FormatError
from voltcam_client.formats.npz_arrays import (
    ArrayHeader,
    array_names,
    check_arrays,
    open_array,
    rows,
)
from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, luminance
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError

DAMAGED = (OSError, EOFError, ValueError, zipfile.BadZipFile, zlib.error)


class NpzSource(RecordedSource):
    """Frames of uint8, uint16 (full scale 65535) or float (0..255), read one at a time: memory stays flat."""

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._path = Path(request.uri)
        try:
            with zipfile.ZipFile(self._path) as archive:
                self._check_names(archive)
                check_arrays(self._path, archive, ("frames", "t_us"))
                with open_array(self._path, archive, "frames") as (header, _):
                    self._frames = self._checked(header)
                with archive.open("t_us.npy") as file:
                    self._t_us = self._check_times(np.lib.format.read_array(file, allow_pickle=False))
        except FileNotFoundError:
            raise SourceError(f"{self._path}: no such file; check the path") from None
        except FormatError as error:
            raise SourceError(str(error)) from None
        except DAMAGED as error:
            raise SourceError(f"{self._path}: damaged or no .npz ({error}); write it again") from None
        self.granted = Granted(
            kind="npz",
            live=False,
            width=self._frames.shape[2],
            height=self._frames.shape[1],
            fps=float((len(self._t_us) - 1) * 1e6 / np.ptp(self._t_us)) if len(self._t_us) > 1 else None,
            pixel_format=str(self._frames.dtype),
            frames=self._frames.shape[0],
            backend=None,
            clock="recording",
            levels=self.levels,
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.path is not None and request.uri.endswith(".npz")

    def _check_names(self, archive: zipfile.ZipFile) -> None:
        found = set(array_names(archive))
        if not {"frames", "t_us"} <= found:
            raise SourceError(
                f"{self._path}: needs frames (N, H, W) uint8 and t_us (N,) int64, "
                f"has {', '.join(sorted(found))}"
            )

    def _checked(self, frames: ArrayHeader) -> ArrayHeader:
        shape, dtype = frames.shape, frames.dtype
        right_shape = (len(shape) == 3 or (len(shape) == 4 and shape[3] == 3)) and 0 not in shape
        right_type = dtype in (np.uint8, np.uint16) or dtype.kind == "f"
        if frames.fortran or not (right_shape and right_type):
            order = ", Fortran order" if frames.fortran else ""
            raise SourceError(
                f"{self._path}: frames is {shape} {dtype}{order}; it must be (N, H, W) or (N, H, W, 3), "
                "uint8, uint16 or float, C order, and not empty"
            )
        return frames

    def _check_times(self, t_us: NDArray[Any]) -> NDArray[np.int64]:
        if t_us.shape != self._frames.shape[:1] or t_us.dtype.kind not in "iu":
            raise SourceError(
                f"{self._path}: t_us is {t_us.shape} {t_us.dtype}; it must be ({self._frames.shape[0]},) "
                "int64, in microseconds"
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
        i = 0
        try:
            with (
                zipfile.ZipFile(self._path) as archive,
                open_array(self._path, archive, "frames") as (header, file),
            ):
                images = rows(file, header)
                for i, (image, t_us) in enumerate(zip(images, self._t_us.tolist(), strict=True)):
                    self._check_values(image, i)
                    grey = luminance(image[..., ::-1] if image.ndim == 3 else image)
                    yield Frame(grey, t_us, gamma=self.gamma)
        except DAMAGED as error:
            raise SourceError(
                f"{self._path}: damaged: {i} of {self._frames.shape[0]} frames read ({error}); write it again"
            ) from None

    def _check_values(self, image: NDArray[Any], index: int) -> None:
        if self._frames.dtype.kind == "f" and not (np.min(image) >= 0 and np.max(image) <= 255):
            raise SourceError(
                f"{self._path}: frames[{index}] has values outside 0..255 (or NaN); scale it to 0..255"
            )
