"""`.h5`, `.hdf5` as DSEC has them: compressed columns, an index by millisecond, width and height.

events/t     uint32, us after t_offset (int64, and no index, where the recording is longer than 71 minutes)
events/x, y  uint16
events/p     uint8, 1 is ON
t_offset     int64, us: a multiple of 2^23, see `start_us`
ms_to_idx    uint64: [ms] is the first event at or after that millisecond
frames       uint8 (M, height, width), and t_us int64, their times: not of DSEC, which has images elsewhere
attributes   width, height, and sensor_resolution (height, width) as event_utils has it

An HDF5 file that is not closed is lost, so a recording is spooled, and put together on close.

Source: dsec.ifi.uzh.ch/data-format.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events
from voltcam_client.formats.library import library
from voltcam_client.formats.recording import Recording
from voltcam_client.formats.spool import blocks
from voltcam_client.formats.spooled import SpooledWriter
from voltcam_client.formats.writer import start_us

_CHUNK = 1 << 17  # events to a chunk


class Hdf5Writer(SpooledWriter):
    """Spools, and makes the HDF5 file on close."""

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool = False) -> None:
        library("h5py", path, "writing")
        library("hdf5plugin", path, "writing")
        super().__init__(path, width, height, overwrite=overwrite)

    def _assemble(self, recording: Recording, path: Path) -> None:
        h5py = library("h5py", path, "writing")
        with h5py.File(path, "w") as file:
            size = (recording.height, recording.width)
            file.attrs.update(height=size[0], width=size[1], sensor_resolution=size)
            _write_events(file, recording.events)
            if recording.frames is not None and recording.frame_t_us is not None:
                frames = _dataset(file, "frames", "u1", (0, *size), (1, *size), "lz4")
                for images in blocks(recording.frames):
                    _append(frames, images)
                _write_out(frames)
                file["t_us"] = recording.frame_t_us


def _write_events(file: Any, events: Events) -> None:
    t_offset = start_us(int(events["t"][0])) if events.size else 0
    span_us = int(events["t"][-1]) - t_offset if events.size else 0
    indexed = span_us < 1 << 32
    columns = {"t": "<u4" if indexed else "<i8", "x": "<u2", "y": "<u2", "p": "u1"}
    datasets = {name: _dataset(file, f"events/{name}", kind) for name, kind in columns.items()}
    index = _dataset(file, "ms_to_idx", "<u8") if indexed else None
    for block in blocks(events):
        t_us = block["t"] - t_offset
        if index is not None:
            ms = np.arange(len(index), t_us[-1] // 1000 + 1)
            _append(index, len(datasets["t"]) + np.searchsorted(t_us, 1000 * ms))
        _append(datasets["t"], t_us)
        for name in "xyp":
            _append(datasets[name], block[name])
    _write_out(*datasets.values(), *([] if index is None else [index]))
    file["t_offset"] = np.int64(t_offset)


def _dataset(
    file: Any,
    name: str,
    kind: str,
    shape: tuple[int, ...] = (0,),
    chunks: tuple[int, ...] = (_CHUNK,),
    compressor: str = "zstd",
) -> Any:
    """lz4 never packs so well that a reader could take the file for a bomb (see `bounds`)."""
    blosc = library("hdf5plugin", Path(file.filename), "writing").Blosc(cname=compressor, clevel=5, shuffle=1)
    return file.create_dataset(name, shape, kind, maxshape=(None, *shape[1:]), chunks=chunks, **blosc)


def _write_out(*datasets: Any) -> None:
    """In this order: else it is the one in which Python lets go of them, which a profiler changes, and the
    same recording is other bytes."""
    for dataset in datasets:
        dataset.flush()


def _append(dataset: Any, rows: NDArray[Any]) -> None:
    count = len(dataset)
    dataset.resize(count + len(rows), axis=0)
    dataset[count:] = rows
