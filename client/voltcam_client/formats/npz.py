"""`.npz`: columns `t, x, y, p` and, with frames, `frames, t_us`, as `np.load` reads them; not compressed.
`exposure_us` (M, 2) has begin and end of each frame's exposure, where frames have such.

An .npz cannot grow, so a recording is spooled into a folder beside it, FILE.npz.partial, and put together on
close, which takes as much disk again. After a crash or on a full disk that folder reads like a recording.

Width and height are in the zip comment, out of the way of everyone else's readers; without one they are the
frames' or the smallest that hold every event.
"""

import contextlib
import os
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.npz_arrays import check_arrays
from voltcam_client.formats.recording import FormatError, Recording, RecordingError, smallest_size
from voltcam_client.formats.spool import Spool, geometry_from_json, geometry_to_json, read_spool
from voltcam_client.formats.writer import Writer, cannot_create, exists_already

DESCRIPTION = "numpy arrays t, x, y, p and, with frames, frames, t_us"
PARTIAL = ".partial"

_BLOCK_BYTES = 1 << 24  # assembled at a time, so that hours take little memory


class NpzWriter(Writer):
    """Spools events and frames in bounded memory and makes the .npz on close."""

    holds_frames = True

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool) -> None:
        super().__init__(path, width, height)
        self._overwrite = overwrite
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
        assembled = self._folder / "assembled.npz"
        try:
            _assemble(read_spool(self._folder), assembled)
            if self._overwrite:
                assembled.replace(self.path)
            else:
                os.link(assembled, self.path)  # fails where another program has made one meanwhile
            shutil.rmtree(self._folder)
        except FileExistsError as error:
            with contextlib.suppress(OSError):
                assembled.unlink()
            self._failure = RecordingError(
                f"{self.path} was made by another program meanwhile: this recording is in {self._rescue()}"
            )
            raise self._failure from error
        except OSError as error:
            with contextlib.suppress(OSError):
                assembled.unlink()
            raise self._failed(error) from error

    def _append(self, events: Events) -> None:
        self._spool.append_events(events)

    def _remedy(self) -> str:
        return f"recover it with 'voltcam convert {self._folder} recovered.npz'"

    def _rescue(self) -> str:
        return f"{self._folder}: {self._remedy()}"


def read_npz(path: Path) -> Recording:
    """Read an .npz of events, with or without frames; FormatError says which array is not as it must be."""
    try:
        with zipfile.ZipFile(path) as archive, np.load(path, allow_pickle=False) as arrays:
            check_arrays(path, archive)
            events = _events(path, arrays)
            if "frames" not in arrays:
                return Recording(events, *_size(archive, events))
            frames = _array(path, arrays, "frames", 3)
            t_us = _array(path, arrays, "t_us", 1)
            exposure_us = _array(path, arrays, "exposure_us", 2) if "exposure_us" in arrays else None
    except (zipfile.BadZipFile, EOFError) as error:
        raise FormatError(f"{path} is cut short or no .npz: copy or record it again") from error
    if frames.dtype != np.uint8 or len(frames) != len(t_us):
        what = f"{len(frames)} {frames.dtype} frames and {len(t_us)} t_us"
        raise FormatError(f"{path} has {what}: give uint8 frames and a time for each")
    if exposure_us is not None and exposure_us.shape != (len(frames), 2):
        shape = exposure_us.shape
        raise FormatError(f"{path} has exposure_us of shape {shape}: give a begin and an end for each frame")
    height, width = frames.shape[1:]
    exposure_us = None if exposure_us is None else exposure_us.astype(np.int64)
    return Recording(events, width, height, frames, t_us.astype(np.int64), exposure_us=exposure_us)


def _events(path: Path, arrays: Any) -> Events:
    events = np.empty(_array(path, arrays, "t", 1).size, EVENT)
    for name in "txyp":
        column = _array(path, arrays, name, 1)
        if column.size != events.size:
            raise FormatError(
                f"{path}: {name} has {column.size} values, t has {events.size}: cut them to one length"
            )
        events[name] = column
        changed = events[name] != column
        if changed.any():
            row = int(np.argmax(changed))
            raise FormatError(f"{path}, event {row}: {name}={column[row]} is no {EVENT[name]}: correct it")
    return events


def _array(path: Path, arrays: Any, name: str, dimensions: int) -> NDArray[Any]:
    """An array of whole numbers or booleans."""
    if name not in arrays:
        raise FormatError(f"{path} has no array {name!r}, only {list(arrays)}: save it under that name")
    try:
        array: NDArray[Any] = arrays[name]
    except ValueError as error:  # Python objects, or not an array at all
        raise FormatError(f"{path}: array {name!r} cannot be read: save it as plain numbers") from error
    if array.ndim != dimensions or array.dtype.kind not in "iub":
        what = f"{array.dtype} of shape {array.shape}"
        raise FormatError(
            f"{path}: array {name!r} is {what}: save whole numbers in {dimensions} dimension(s)"
        )
    return array


def _size(archive: zipfile.ZipFile, events: Events) -> tuple[int, int]:
    try:
        return geometry_from_json(archive.comment)
    except ValueError:
        return smallest_size(events)


def _assemble(recording: Recording, path: Path) -> None:
    """Write the .npz, a block at a time; it is on the disk, not in a cache, when this returns."""
    with path.open("wb") as file:
        with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
            for name in "txyp":
                _write_array(archive, name, recording.events[name])
            if recording.frames is not None and recording.frame_t_us is not None:
                _write_array(archive, "frames", recording.frames)
                _write_array(archive, "t_us", recording.frame_t_us)
            if recording.exposure_us is not None:
                _write_array(archive, "exposure_us", recording.exposure_us)
            archive.comment = geometry_to_json(recording.width, recording.height).encode("ascii")
        file.flush()
        os.fsync(file.fileno())


def _write_array(archive: zipfile.ZipFile, name: str, array: NDArray[Any]) -> None:
    """One .npy member, as np.savez makes it."""
    with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
        np.lib.format.write_array_header_1_0(member, np.lib.format.header_data_from_array_1_0(array))
        rows = max(1, _BLOCK_BYTES // max(1, array[:1].nbytes))
        for start in range(0, len(array), rows):
            member.write(array[start : start + rows].tobytes())
