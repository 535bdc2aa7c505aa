"""How long ago, before each event, what could have to do with it fired: stamps and addresses alone."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events
from voltcam_simulator.kernel import kernel

NEVER_US = -(1 << 60)
FAR_PIXELS = 2  # what is nearer belongs to the neighbours, not to the row or the column


class Past(NamedTuple):
    """For each event (n,) int64 [us] since the last event before it; a huge number where there was none.

    own_same, own_other: of its pixel, by polarity. near_same, near_other: of its four neighbours. row,
    column: of the same line, more than two pixels away. anybody: of the whole sensor.
    """

    own_same: NDArray[np.int64]
    own_other: NDArray[np.int64]
    near_same: NDArray[np.int64]
    near_other: NDArray[np.int64]
    row: NDArray[np.int64]
    column: NDArray[np.int64]
    anybody: NDArray[np.int64]


def past_of(events: Events, width: int, height: int) -> Past:
    """The past of every event of a stream sorted by time; of one time, those before it count."""
    past = Past(*np.empty((7, len(events)), np.int64))
    last = np.full((2, height, width), NEVER_US, np.int64)
    look_back(events, last, np.full((height, width), NEVER_US, np.int64), past)
    return past


@kernel
def look_back(events: Any, last: Any, latest: Any, past: Any) -> None:
    """last (2, height, width): time of each pixel's last event by polarity; latest: the later of the two."""
    height, width = latest.shape
    before = NEVER_US
    for i in range(events.shape[0]):
        t, x, y = events[i].t, np.int64(events[i].x), np.int64(events[i].y)
        same = 1 if events[i].p else 0
        past.own_same[i] = t - last[same, y, x]
        past.own_other[i] = t - last[1 - same, y, x]
        near_same = near_other = row = column = np.int64(NEVER_US)
        for dx, dy in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            u, v = x + dx, y + dy
            if 0 <= u < width and 0 <= v < height:
                near_same = max(near_same, last[same, v, u])
                near_other = max(near_other, last[1 - same, v, u])
        past.near_same[i], past.near_other[i] = t - near_same, t - near_other
        for other in range(width):
            if abs(other - x) > FAR_PIXELS:
                row = max(row, latest[y, other])
        for other in range(height):
            if abs(other - y) > FAR_PIXELS:
                column = max(column, latest[other, x])
        past.row[i], past.column[i], past.anybody[i] = t - row, t - column, t - before
        last[same, y, x] = latest[y, x] = before = t
