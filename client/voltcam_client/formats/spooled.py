"""Recordings whose file cannot grow safely: spooled beside it, in FILE.partial, and put together on close.

That takes as much disk again. After a crash or on a full disk the folder reads like a recording.
"""

import contextlib
import os
import shutil
from abc import abstractmethod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events
from voltcam_client.formats.recording import Recording, RecordingError
from voltcam_client.formats.spool import PARTIAL, Spool, read_spool
from voltcam_client.formats.writer import Writer, cannot_create, exists_already


class SpooledWriter(Writer):
    """Spools events and frames in bounded memory; a format puts its file together from them."""

    holds_frames = True

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool = False) -> None:
        super().__init__(path, width, height, overwrite=overwrite)
        self._folder = path.with_name(path.name + PARTIAL)
        if path.exists() and not overwrite:
            raise exists_already(path)
        if self._folder.exists() and not overwrite:
            raise RecordingError(f"{self._folder} is an unfinished recording: {self._remedy()}, or remove it")
        try:
            self._spool = Spool(self._folder, width, height)
        except OSError as error:
            raise cannot_create(path, error) from error

    def frame(self, image: NDArray[np.uint8], t_us: int) -> None:
        self._frame(image, t_us, (t_us, t_us))

    def aps_frame(
        self,
        image: NDArray[np.uint8],
        exposure_us: tuple[int, int],
        frame_us: tuple[int, int] | None = None,
    ) -> None:
        self._frame(image, sum(exposure_us) // 2, exposure_us)

    def _frame(self, image: NDArray[np.uint8], t_us: int, exposure_us: tuple[int, int]) -> None:
        self._check_image(image)
        with self._writing():
            self._spool.append_frame(image, t_us, exposure_us)

    def close(self) -> None:
        if self._closed:
            return
        super().close()
        self._spool.close()
        if self._failure:
            return
        assembled = self._folder / f"assembled{self.path.suffix}"
        try:
            self._assemble(read_spool(self._folder), assembled)
            _to_disk(assembled)
            if self._overwrite:
                assembled.replace(self.path)
            else:
                os.link(assembled, self.path)  # fails where another program has made one meanwhile
            shutil.rmtree(self._folder)
        except Exception as error:
            with contextlib.suppress(OSError):
                assembled.unlink()
            self._failure = self._unfinished(error)
            raise self._failure from error

    def _unfinished(self, error: Exception) -> RecordingError:
        if isinstance(error, FileExistsError):
            return RecordingError(
                f"{self.path} was made by another program meanwhile: this recording is in {self._rescue()}"
            )
        if isinstance(error, OSError) and error.strerror:
            return self._failed(error)
        reason = next(iter(str(error).splitlines()), type(error).__name__)  # of a library
        return RecordingError(f"{self.path}: {reason}: this recording is in {self._rescue()}")

    @abstractmethod
    def _assemble(self, recording: Recording, path: Path) -> None:
        """Make the file, block by block: the recording is mapped, and may be larger than the memory."""

    def _append(self, events: Events) -> None:
        self._spool.append_events(events)

    def _remedy(self) -> str:
        return f"recover it with 'voltcam convert {self._folder} recovered{self.path.suffix}'"

    def _rescue(self) -> str:
        return f"{self._folder}: {self._remedy()}"


def _to_disk(path: Path) -> None:
    """On the disk, not in a cache, when this returns: what it was made from is removed next."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
