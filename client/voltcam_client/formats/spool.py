"""A recording under way, in a folder that only grows: what an `.npz` is made from, and recovered from.

geometry.json     {"width": ..., "height": ...}
events.bin        EVENT records, 13 bytes each
frames.bin        frames, height x width bytes each
frame_t_us.bin    their times, int64
exposure_us.bin   begin and end of their exposures, two int64, both the frame's time where it has none
"""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.recording import FormatError, Recording, exposures_known
from voltcam_client.formats.writer import AppendFile

PARTIAL = ".partial"  # after the name of the file that is made from it

_BLOCK_BYTES = 1 << 24  # read at a time, so that hours take little memory


class Spool:
    """The folder while it is written; replaces a folder of that name."""

    def __init__(self, folder: Path, width: int, height: int) -> None:
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir()
        try:
            (folder / "geometry.json").write_text(geometry_to_json(width, height))
            self._events = AppendFile(folder / "events.bin", overwrite=False)
            self._frames = AppendFile(folder / "frames.bin", overwrite=False)
            self._exposure_us = AppendFile(folder / "exposure_us.bin", overwrite=False)
            self._frame_t_us = AppendFile(folder / "frame_t_us.bin", overwrite=False)
        except OSError:
            shutil.rmtree(folder, ignore_errors=True)  # not to be taken for a recording
            raise

    def append_events(self, events: Events) -> None:
        self._events.append(events.tobytes())

    def append_frame(self, image: NDArray[np.uint8], t_us: int, exposure_us: tuple[int, int]) -> None:
        self._frames.append(image.tobytes())
        self._exposure_us.append(np.array(exposure_us, np.int64).tobytes())
        self._frame_t_us.append(np.int64(t_us).tobytes())

    def close(self) -> None:
        for file in (self._events, self._frames, self._exposure_us, self._frame_t_us):
            file.close()


def read_spool(folder: Path) -> Recording:
    """Read the folder, mapped from the disk; what a crash has cut in half is left out."""
    try:
        width, height = geometry_from_json((folder / "geometry.json").read_bytes())
    except (FileNotFoundError, ValueError) as error:
        raise FormatError(
            f"{folder} holds no recording, it ended before the first event: remove it"
        ) from error
    events: Events = _mapped(folder / "events.bin", EVENT)
    frames: NDArray[np.uint8] = _mapped(folder / "frames.bin", np.uint8, (height, width))
    frame_t_us: NDArray[np.int64] = _mapped(folder / "frame_t_us.bin", np.int64)
    count = min(len(frames), len(frame_t_us))  # a crash may have come between the two
    if count == 0:
        return Recording(events, width, height)
    exposure_us: NDArray[np.int64] = _mapped(folder / "exposure_us.bin", np.int64, (2,))
    known = len(exposure_us) >= count and exposures_known(exposure_us[:count])
    return Recording(
        events,
        width,
        height,
        frames[:count],
        frame_t_us[:count],
        exposure_us=exposure_us[:count] if known else None,
    )


def geometry_to_json(width: int, height: int) -> str:
    return json.dumps({"width": width, "height": height})


def geometry_from_json(text: bytes) -> tuple[int, int]:
    """Width and height; ValueError for any other text."""
    try:
        geometry = json.loads(text)
        return int(geometry["width"]), int(geometry["height"])
    except (KeyError, TypeError) as error:
        raise ValueError("not a geometry") from error


def blocks(array: NDArray[Any]) -> Iterator[NDArray[Any]]:
    """A mapped array, one piece after the other."""
    rows = max(1, _BLOCK_BYTES // max(1, array[:1].nbytes))
    for start in range(0, len(array), rows):
        yield array[start : start + rows]


def _mapped(path: Path, dtype: Any, shape: tuple[int, ...] = ()) -> NDArray[Any]:
    """The whole records, of this dtype and shape, of a file that may not be there yet."""
    record_bytes = np.dtype((dtype, shape)).itemsize
    count = path.stat().st_size // record_bytes if path.exists() else 0
    if count == 0:  # nothing that could be mapped
        return np.empty((0, *shape), dtype)
    return np.memmap(path, dtype, mode="r", shape=(count, *shape))
