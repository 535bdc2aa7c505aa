"""Where the light between frames is known, and from which event of a pixel to the next it has been."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.kernel import kernel

Events = NDArray[np.void]
SETTLED_US = 500_000
"""How long voltages tell of light that is not known, at most, where no event came since. Measured: where the
generator's light has just gone dark, pixels at rest give OFF events for 200 ms."""


@dataclass(frozen=True, eq=False)
class KnownLight:
    """gaps: (M - 1, pixels), whether light between a frame and the next is known well enough. taken_us: (M,)
    of the frames, ascending. width: columns of the sensor; a pixel's number is y width + x."""

    gaps: NDArray[np.bool_]
    taken_us: NDArray[np.int64]
    width: int

    @classmethod
    def everywhere(cls, taken_us: NDArray[np.int64], height: int, width: int) -> "KnownLight":
        """All of it, between these frames."""
        return cls(np.ones((len(taken_us) - 1, height * width), np.bool_), taken_us, width)

    def all_around(self) -> "KnownLight":
        """Where it is known in the gaps before and behind, too, as far as there are any."""
        gaps = self.gaps.copy()
        gaps[1:] &= self.gaps[:-1]
        gaps[:-1] &= self.gaps[1:]
        return replace(self, gaps=gaps)

    @cached_property
    def last_unknown(self) -> NDArray[np.int32]:
        """(M - 1, pixels): the last gap, up to and with each one, in which light is not known; -1: none.

        Two events between which this changes have light between them that is not known.
        """
        gaps = np.arange(len(self.gaps), dtype=np.int32)[:, None]
        return np.asarray(np.maximum.accumulate(np.where(self.gaps, np.int32(-1), gaps), axis=0))

    def within(self, events: Events) -> NDArray[np.bool_]:
        """(n,): whether each of n events (EVENT, in any order) is between frames, where light is known."""
        gap, pixel = self._places(events)
        there: NDArray[np.bool_] = (gap >= 0) & self.gaps[gap, pixel]
        return there

    def where(self, events: Events) -> Events:
        """The events that are `within`."""
        found: Events = events.compress(self.within(events))  # 8 times as fast as by an index
        return found

    def stretch(self, events: Events) -> NDArray[np.int32]:
        """(n,): `last_unknown` of each of n events that are `within`."""
        return self.last_unknown[self._places(events)]

    def settled(self, events: Events) -> NDArray[np.bool_]:
        """(n,): of events that are `within`, whether light that is not known cannot have made one: it is
        SETTLED_US ago, or another of these events of the pixel came since."""
        gap, pixel = self._places(events)
        stretch = self.last_unknown[gap, pixel]
        order = np.lexsort((events["t"], pixel))
        first = np.ones(len(events), np.bool_)
        first[order[1:]] = np.any(np.diff([pixel[order], stretch[order]]) != 0, axis=0)
        return ~first | (events["t"] >= self.taken_us[stretch + 1] + SETTLED_US)

    def _places(self, events: Events) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """(n,) gaps, -1 outside of the frames, and (n,) pixels."""
        gap, pixel = np.empty((2, len(events)), np.int32)
        t_us, x, y = (np.ascontiguousarray(events[name]) for name in "txy")
        _place(t_us, x, y, self.taken_us, self.width, gap, pixel)
        return gap, pixel


@kernel
def _place(t_us: Any, x: Any, y: Any, taken_us: Any, width: Any, gap: Any, pixel: Any) -> None:
    """Fill gap and pixel. An event on a frame is of the gap behind it, on the last one of that before."""
    at, last = 0, taken_us.size - 2
    for i in range(t_us.size):
        pixel[i] = np.int64(y[i]) * width + x[i]
        if t_us[i] < taken_us[0] or t_us[i] > taken_us[last + 1]:
            gap[i] = -1
            continue
        while at < last and t_us[i] >= taken_us[at + 1]:
            at += 1
        while t_us[i] < taken_us[at]:
            at -= 1
        gap[i] = at
