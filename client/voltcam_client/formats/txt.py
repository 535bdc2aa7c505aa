"""`.txt`: the text of the Event Camera Dataset, one event `t x y p` per line, t in seconds, p 0 or 1.

Also read: the dataset's folder, with `events.txt`, `images.txt` (`t path` per line) and the images.

Source: Mueggler et al., The Event-Camera Dataset and Simulator, IJRR 2017; rpg.ifi.uzh.ch/davis_data.html.
"""

import contextlib
import struct
from pathlib import Path

import numpy as np

from voltcam_client.encodings import Events
from voltcam_client.formats.columns import Layout, format_rows, read_events
from voltcam_client.formats.image_list import IMAGE_LIST, read_image_list
from voltcam_client.formats.recording import Recording, smallest_size
from voltcam_client.formats.writer import AppendWriter

DESCRIPTION = "events as text, 't_seconds x y p' as in the Event Camera Dataset, for evlib, too"

_LAYOUT = Layout(columns="t x y p", separator=None, seconds=True)


class TxtWriter(AppendWriter):
    """Appends lines `t x y p`, t in seconds with six decimals."""

    def _encode(self, events: Events) -> bytes:
        seconds, microseconds = np.divmod(events["t"], 1_000_000)
        return format_rows("%d.%06d %d %d %d\n", seconds, microseconds, events["x"], events["y"], events["p"])


def read_txt(path: Path) -> Recording:
    """Read a text of events; FormatError names a line that is none. Times are rounded to microseconds."""
    events = read_events(path, _LAYOUT)
    return Recording(events, *smallest_size(events))


def read_folder(folder: Path) -> Recording:
    """Read an Event Camera Dataset folder: the events, and the paths and times of the images, if any."""
    events = read_events(folder / "events.txt", _LAYOUT)
    image_list = folder / IMAGE_LIST
    if not image_list.exists():
        return Recording(events, *smallest_size(events))
    listed = read_image_list(image_list)
    paths = tuple(image.path for image in listed)
    t_us = np.array([image.t_us for image in listed], np.int64)
    size = _png_size(paths[0]) if paths else None
    return Recording(events, *(size or smallest_size(events)), frame_t_us=t_us, image_paths=paths)


def _png_size(path: Path) -> tuple[int, int] | None:
    """Width and height in a PNG's first chunk; None for another kind of image, or none there."""
    with contextlib.suppress(OSError), path.open("rb") as file:
        start = file.read(24)
        if start[:8] == b"\x89PNG\r\n\x1a\n" and len(start) == 24:
            width, height = struct.unpack(">II", start[16:])
            return width, height
    return None
