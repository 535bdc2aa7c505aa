"""Some rows of the sensor, and the room in which one thread works on them."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .effect import Band, Plane
from .kernel import kernel
from .limits import Limits, TooManyEventsError

Keys = NDArray[np.uint64]
Image = NDArray[np.uint8] | Plane

FIRST_KEYS, MOST_KEYS_MORE = (
    8192,
    1 << 20,
)  # space for events before any has come, and what it grows by at once


class Room:
    """What one thread needs for a band at a time: scratch planes, and space for event keys that grows."""

    def __init__(self, pixels: int) -> None:
        self.planes = np.empty((4, pixels), np.float32)
        self.zeros = np.zeros(pixels, np.float32)  # for pixels without dead times, without kicks
        self.near = np.empty(pixels + 1, np.int32)
        self._keys = np.empty(FIRST_KEYS, np.uint64)
        self._filled = 0
        self.most_keys, self.limits = sys.maxsize, Limits()  # of one interval

    def draw(self, count: int, draw: Callable[[int, Keys], tuple[int, int]]) -> None:
        """Let draw(pixels done, space) -> (pixels done, keys written) go on until count pixels are done."""
        done = 0
        while done < count:
            done, written = draw(done, self._keys[self._filled :])
            self._filled += written
            if done < count:
                self.limits.hurry()
                self._grow()

    def _grow(self) -> None:
        size = self._keys.size
        if size >= self.most_keys:
            raise TooManyEventsError
        more = min(size, MOST_KEYS_MORE, self.most_keys - size)
        self._keys = np.concatenate([self._keys, np.empty(more, np.uint64)])

    def take_keys(self) -> Keys:
        """The keys drawn since the last call; good until the next draw."""
        keys, self._filled = self._keys[: self._filled], 0
        return keys

    def forget_keys(self) -> None:
        """Drop what has been drawn, and the space for it."""
        self._keys, self._filled = np.empty(FIRST_KEYS, np.uint64), 0

    @property
    def nbytes(self) -> int:
        """Memory of the scratch planes, without the events."""
        return self.planes.nbytes + self.zeros.nbytes + self.near.nbytes

    @property
    def event_bytes(self) -> int:
        """Memory of the space for event keys."""
        return self._keys.nbytes


@dataclass(slots=True, eq=False)
class Rows:
    """A band, the room it is worked on in, and the sensor's own planes at its place."""

    room: Room
    band: Band
    pixels: slice
    voltage: Plane
    pending: Plane
    light: Plane
    response: Plane
    held: Plane
    above: Plane
    below: Plane
    quiet: NDArray[np.int32]  # (rows,): steps without change
    ahead: NDArray[np.bool_]  # (rows,): which are drawn ahead, see `waiting_times.py`, and since when
    begun: Plane
    due: Plane
    motion: Plane
    rows_ahead: int = 0  # how many


NO_KICKS, NO_SLACK = np.empty((0, 1)), np.empty(0, np.float32)


def kick_arrays(band: Band) -> tuple[NDArray[np.float64], NDArray[np.float64], Plane]:
    """A band's kicks: times and sizes (kicks, rows), each row in order of time, and how far they lead astray.

    What a row does not have in this step stands at its end, at inf, with size 0. Astray is what the mean
    path of each row, straight between kicks, may go beyond its two ends: the largest sum of kicks up to or
    from a time, more than 0 where there is any kick.
    """
    if not band.kicks:
        return NO_KICKS, NO_KICKS, NO_SLACK
    band.kicks.sort(key=lambda kick: kick[0][0])  # of the first row: what is nearly in order is quick to sort
    times = np.stack([times for times, _ in band.kicks])
    sizes, slack = np.empty_like(times), np.empty(times.shape[1], np.float32)
    _in_order(np.array([size for _, size in band.kicks], np.float64), band.span_us, times, sizes, slack)
    return times, sizes, slack


@kernel
def _in_order(size: Any, span: Any, times: Any, sizes: Any, slack: Any) -> None:
    """Sort `times` (kicks, rows) and lay out `sizes` beside them; size: (kicks,)."""
    kicks, rows = times.shape
    for row in range(rows):
        total = 0.0
        for k in range(kicks):
            at, of = times[k, row], size[k]
            if not (0 < at <= span):
                at, of = np.inf, 0.0
            total += of
            place = k
            while place > 0 and times[place - 1, row] > at:
                times[place, row], sizes[place, row] = times[place - 1, row], sizes[place - 1, row]
                place -= 1
            times[place, row], sizes[place, row] = at, of
        before = furthest = 0.0
        for k in range(kicks):
            before += sizes[k, row]
            furthest = max(furthest, abs(before), abs(total - before))
        slack[row] = furthest
