"""What one sees of an item: a frame, and the events around it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voltcam_client.formats import FormatError, RecordingError, read
from voltcam_lab.pages.style import ON_OFF, styled

from .manifest import Record

SHOWN = 12  # events a pixel of the busiest moment: what is brighter is cut


@dataclass(frozen=True)
class Picture:
    """frame: (H, W) uint8 or None. events: (H, W), ON less OFF over the span."""

    frame: NDArray[np.uint8] | None
    events: NDArray[np.int64]
    span_us: int


def picture_of(folder: Path, record: Record) -> Picture | None:
    """From the middle of an item; None where it cannot be read."""
    try:
        recording = read(folder / record["path"])
    except (FormatError, RecordingError):
        return None
    events, shape = recording.events, (record["height"], record["width"])
    middle_us = record["begin_us"] + int(record["seconds"] * 5e5)
    # So long that one pixel in three has an event, at the item's own rate.
    span_us = int(np.clip(shape[0] * shape[1] / 3 / max(record["events_per_s"], 1) * 1e6, 1000, 100_000))
    first, last = np.searchsorted(events["t"], [middle_us - span_us // 2, middle_us + span_us // 2])
    image = np.zeros(shape, np.int64)
    part = events[first:last]
    np.add.at(image, (part["y"], part["x"]), np.where(part["p"], 1, -1))
    frame = None
    if recording.frames is not None and recording.frame_t_us is not None and len(recording.frames):
        frame = recording.frames[int(np.argmin(np.abs(recording.frame_t_us - middle_us)))].copy()
    return Picture(frame, image, span_us)


@styled
def drawn_picture(picture: Picture) -> Figure:
    """The frame and the events beside each other."""
    columns = 1 if picture.frame is None else 2
    height, width = picture.events.shape
    figure = Figure((2.3 * columns, 2.3 * height / width), layout=None)
    figure.subplots_adjust(0, 0, 1, 1, 0.02, 0)
    axes: Any = figure.subplots(1, columns, squeeze=False)[0]
    if picture.frame is not None:
        axes[0].imshow(picture.frame, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    most = max(1, min(SHOWN, int(np.percentile(np.abs(picture.events), 99.5))))
    axes[-1].imshow(picture.events, cmap=ON_OFF, vmin=-most, vmax=most, interpolation="nearest")
    for one in axes:
        one.set_xticks([])
        one.set_yticks([])
        one.set_frame_on(False)
    return figure
