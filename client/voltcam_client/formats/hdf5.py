"""`.h5`, `.hdf5`: columns of events as DSEC has them, as event_utils and e2vid have, or as MVSEC.

DSEC: `events/{x, y, t, p}`, t in us after `t_offset`; an index `ms_to_idx`, not needed to read all of it.
event_utils: `events/{xs, ys, ts, ps}`, ts in seconds; `images/image000000000`... with the attribute
`timestamp` in seconds; `sensor_resolution` (height, width). Polarities are 0 or -1 for OFF, 1 for ON.
Frames of either layout are also taken from `frames` (N, H, W) and `t_us`, as in an `.npz`.
MVSEC: `davis/left/events` (N, 4) of x, y, t in seconds, p; `davis/left/image_raw` (M, H, W) at
`davis/left/image_raw_ts` in seconds. The left camera is read, the right one where there is no other.
Blosc and Zstandard go through hdf5plugin.

Sources: dsec.ifi.uzh.ch/data-format; github.com/TimoStoff/event_utils; daniilidis-group.github.io/mvsec.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.bounds import fits
from voltcam_client.formats.library import grey, library, named, stacked
from voltcam_client.formats.recording import FormatError, Recording, smallest_size

DESCRIPTION = (
    "HDF5 columns as in DSEC (events/t, x, y, p) or event_utils (events/ts, xs, ys, ps); MVSEC is read, too"
)

_LAYOUTS = (("t", "x", "y", "p"), ("ts", "xs", "ys", "ps"))
_MVSEC = ("davis/left", "davis/right")
_Frames = tuple[NDArray[np.uint8] | None, NDArray[np.int64] | None]  # and their times
_ROWS = 1 << 20  # of four numbers, read at a time


def read_hdf5(path: Path) -> Recording:
    """Read the events and, where the file has some, the frames. FormatError names what is missing."""
    h5py = library("h5py", path)
    library("hdf5plugin", path)  # registers the filters
    with named(path, "HDF5 file"), h5py.File(path, "r") as file:
        if camera := _mvsec_camera(path, file):
            events, (frames, t_us) = _mvsec(path, file, camera)
        else:
            events, (frames, t_us) = _events(path, file), _frames(path, file)
        size = _size(file, events, frames)
    return Recording(events, *size, frames=frames, frame_t_us=t_us)


def _events(path: Path, file: Any) -> Events:
    _check_link(path, file, "events")
    group = file.get("events", file)
    for layout in _LAYOUTS:
        if layout[0] in group:
            break
    else:
        raise FormatError(f"{path} has no events/t, only {list(file)}: give columns t, x, y, p")
    missing = [name for name in layout if name not in group]
    if missing:
        raise FormatError(f"{path} has no events/{missing[0]}: give columns {', '.join(layout)}")
    t, x, y, p = (_array(path, group, name).ravel() for name in layout)
    if not t.size == x.size == y.size == p.size:
        raise FormatError(f"{path}: its columns have {t.size}, {x.size}, {y.size}, {p.size} events: cut them")
    events = np.empty(t.size, EVENT)
    events["t"] = _us(t) + (int(_array(path, file, "t_offset").ravel()[0]) if "t_offset" in file else 0)
    events["x"], events["y"], events["p"] = x, y, p > 0
    return events


def _mvsec_camera(path: Path, file: Any) -> str:
    """Where a file of MVSEC has its events; empty for another file."""
    for camera in _MVSEC:
        _check_link(path, file, f"{camera}/events")
        if f"{camera}/events" in file:
            return camera
    return ""


def _mvsec(path: Path, file: Any, camera: str) -> tuple[Events, _Frames]:
    rows = _dataset(path, file, f"{camera}/events")
    if rows.ndim != 2 or rows.shape[1] != 4:
        raise FormatError(f"{path}: {camera}/events is {rows.shape}, not (N, 4): give rows of x, y, t, p")
    events = np.empty(len(rows), EVENT)
    for start in range(0, len(rows), _ROWS):
        x, y, t, p = rows[start : start + _ROWS].T
        block = events[start : start + _ROWS]
        block["t"], block["x"], block["y"], block["p"] = _us(t), x, y, p > 0
    if f"{camera}/image_raw" not in file:
        return events, (None, None)
    frames = stacked([grey(image) for image in _array(path, file, f"{camera}/image_raw")], path)
    return events, (frames, _us(_array(path, file, f"{camera}/image_raw_ts")))


def _check_link(path: Path, group: Any, name: str) -> None:
    """Nothing but the file itself is read. Raises FormatError for a link to another, at any step."""
    steps = name.split("/")
    for count in range(1, len(steps) + 1):
        step = "/".join(steps[:count])
        link = group.get(step, getlink=True)
        if type(link).__name__ == "ExternalLink":
            raise FormatError(f"{path}: {step} is a link into another file: copy its data into this one")
        if link is None:
            return


def _array(path: Path, group: Any, name: str) -> NDArray[Any]:
    """All of a dataset. Raises FormatError."""
    array: NDArray[Any] = _dataset(path, group, name)[()]
    return array


def _dataset(path: Path, group: Any, name: str) -> Any:
    """Numbers that are in this file and no more than it can hold. Raises FormatError."""
    _check_link(path, group, name)
    if name not in group:
        raise FormatError(f"{path} has no {name}: is it a whole file of its data set?")
    dataset = group[name]
    if dataset.external or dataset.is_virtual:
        raise FormatError(f"{path}: the data of {name} are in another file: copy them into this one")
    if dataset.dtype.kind not in "iufb":
        raise FormatError(f"{path}: {name} holds no numbers: save it as numbers")
    fits(path, dataset.size * dataset.dtype.itemsize)
    return dataset


def _us(t: NDArray[Any]) -> NDArray[np.int64]:
    """Whole numbers are microseconds, others seconds."""
    return np.rint(t * 1e6).astype(np.int64) if t.dtype.kind == "f" else t.astype(np.int64)


def _frames(path: Path, file: Any) -> _Frames:
    if "frames" in file and "t_us" in file:
        frames = stacked([grey(image) for image in _array(path, file, "frames")], path)
        return frames, _array(path, file, "t_us").astype(np.int64)
    _check_link(path, file, "images")
    names = sorted(file["images"]) if "images" in file else []
    for name in names:
        _check_link(path, file["images"], name)
    images = [file["images"][name] for name in names]
    if not images or any("timestamp" not in image.attrs for image in images):
        return None, None  # DSEC keeps its images elsewhere
    seconds = np.array([float(image.attrs["timestamp"]) for image in images])
    pictures = [grey(_array(path, file["images"], name), "BGR") for name in names]
    return stacked(pictures, path), _us(seconds)


def _size(file: Any, events: Events, frames: NDArray[np.uint8] | None) -> tuple[int, int]:
    if frames is not None:
        return frames.shape[2], frames.shape[1]
    width, height = smallest_size(events)
    if "sensor_resolution" in file.attrs:
        rows, columns = (int(side) for side in file.attrs["sensor_resolution"])
        for sides in ((columns, rows), (rows, columns)):  # some write width first
            if width <= sides[0] and height <= sides[1]:
                return sides
    return width, height
