"""What a recording is, in memory and on disk, and what can be wrong with it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events
from voltcam_client.errors import VoltcamError

# Times outside are no microseconds (2^32 s is the year 2106). Inside, a decimal in seconds held in a float64
# is less than half a microsecond off, which is why text files are exact.
MAX_T_US = 2**32 * 1_000_000
LONGEST_SIDE = 1 << 16  # pixels: events keep 16 bits for x and y

_BLOCK = 1 << 20  # events checked at a time: a mapped recording may be larger than the memory


class FormatError(VoltcamError):
    """No recording format has this suffix, or the file is not what its suffix says. One line."""


class RecordingError(OSError):
    """The file cannot be made, read or written. One line: what went wrong, what is safe where, what to do."""


@dataclass(frozen=True, eq=False)
class Recording:
    """A recording, in memory or mapped from the disk.

    - `events`: (N,) EVENT, sorted by t.
    - `width`, `height`: pixels; where the file does not say (plain text), the smallest that hold every event.
    - `frames`: (M, H, W) uint8, grey levels; None without frames.
    - `frame_t_us`: (M,) int64, their times; None without frames.
    - `image_paths`: of an Event Camera Dataset folder, in place of `frames`: decoding them takes an image
      library, which voltcam_video has.
    - `exposure_us`: (M, 2) int64, when each frame's exposure began and ended; None where that is not said.
    """

    events: Events
    width: int
    height: int
    frames: NDArray[np.uint8] | None = None
    frame_t_us: NDArray[np.int64] | None = None
    image_paths: tuple[Path, ...] = ()
    exposure_us: NDArray[np.int64] | None = None


def smallest_size(events: Events) -> tuple[int, int]:
    """Width and height of the smallest sensor that holds every event; (0, 0) without events."""
    if events.size == 0:
        return 0, 0
    return int(events["x"].max()) + 1, int(events["y"].max()) + 1


def exposures_known(exposure_us: NDArray[np.int64]) -> bool:
    """Whether (M, 2) begins and ends are exposures: a frame without one has its time as both."""
    return bool((exposure_us[:, 1] > exposure_us[:, 0]).all())


def fault_in(
    events: Events,
    width: int,
    height: int,
    after_t_us: int | None = None,
    longest_silence_us: int = MAX_T_US,
) -> str | None:
    """What keeps `events` from being a recording of this size, in words, or None. Events count from 0."""
    for start in range(0, events.size, _BLOCK):
        block = events[start : start + _BLOCK]
        t = block["t"]
        silence_us = np.diff(t, prepend=t[:1] if after_t_us is None else after_t_us)
        after_t_us = int(t[-1])
        faults = (
            ((t < 0) | (t >= MAX_T_US), "t must be microseconds, 0 to 2^32 seconds"),
            (silence_us < 0, "t goes back: sort the events by time"),
            (silence_us > longest_silence_us, "t leaps by more than a year: begin another recording"),
            (block["x"] >= width, f"x is outside a width of {width}"),
            (block["y"] >= height, f"y is outside a height of {height}"),
        )
        for faulty, what in faults:
            if faulty.any():
                row = int(np.argmax(faulty))
                event = block[row]
                return f"event {start + row} (t={event['t']} x={event['x']} y={event['y']}): {what}"
    return None
