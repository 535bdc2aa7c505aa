"""`.npz`: columns `t, x, y, p` and, with frames, `frames, t_us`, as `np.load` reads them; not compressed.
`exposure_us` (M, 2) has begin and end of each frame's exposure, where frames have such.

An .npz cannot grow, so a recording is spooled, and put together on close.

Width and height are arrays without a dimension; where they are not there, they are those of the zip comment
that older Voltcams wrote, the frames', or the smallest that hold every event.
"""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.npz_arrays import check_arrays
from voltcam_client.formats.recording import FormatError, Recording, smallest_size
from voltcam_client.formats.spool import blocks, geometry_from_json
from voltcam_client.formats.spooled import SpooledWriter

DESCRIPTION = "numpy arrays t, x, y, p, width, height and, with frames, frames, t_us"


class NpzWriter(SpooledWriter):
    """Spools events and frames in bounded memory and makes the .npz on close."""

    def _assemble(self, recording: Recording, path: Path) -> None:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
            for name in "txyp":
                _write_array(archive, name, recording.events[name])
            _write_array(archive, "width", np.array(recording.width))
            _write_array(archive, "height", np.array(recording.height))
            if recording.frames is not None and recording.frame_t_us is not None:
                _write_array(archive, "frames", recording.frames)
                _write_array(archive, "t_us", recording.frame_t_us)
            if recording.exposure_us is not None:
                _write_array(archive, "exposure_us", recording.exposure_us)


def read_npz(path: Path) -> Recording:
    """Read an .npz of events, with or without frames; FormatError says which array is not as it must be."""
    try:
        with zipfile.ZipFile(path) as archive, np.load(path, allow_pickle=False) as arrays:
            check_arrays(path, archive)
            events = _events(path, arrays)
            if "frames" not in arrays:
                return Recording(events, *_size(path, arrays, archive, events))
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


def _size(path: Path, arrays: Any, archive: zipfile.ZipFile, events: Events) -> tuple[int, int]:
    if "width" in arrays and "height" in arrays:
        return int(_array(path, arrays, "width", 0)), int(_array(path, arrays, "height", 0))
    try:
        return geometry_from_json(archive.comment)
    except ValueError:
        return smallest_size(events)


def _write_array(archive: zipfile.ZipFile, name: str, array: NDArray[Any]) -> None:
    """One .npy member, as np.savez makes it."""
    with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
        np.lib.format.write_array_header_1_0(member, np.lib.format.header_data_from_array_1_0(array))
        for block in blocks(np.atleast_1d(array)):
            member.write(block.tobytes())
