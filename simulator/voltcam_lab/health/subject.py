"""A recording under examination: its events, each with what the light did at its pixel."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..recordings import Footage
from .light_change import LightChange, light_change_of


@dataclass(frozen=True, eq=False)
class Subject:
    """interval: (n,) the frame interval of each event, -1 before and after the frames. at_rest: (n,) whether
    the event's pixel is at rest then."""

    footage: Footage
    light: LightChange
    interval: NDArray[np.int64]
    at_rest: NDArray[np.bool_]

    @property
    def period_us(self) -> float:
        """Between frames."""
        return float(np.median(np.diff(self.light.t_us)))

    @property
    def t_us(self) -> NDArray[np.int64]:
        """(n,) of the events."""
        return self.footage.events["t"]

    @property
    def on(self) -> NDArray[np.bool_]:
        """(n,) polarity."""
        return self.footage.events["p"]

    @property
    def y(self) -> NDArray[np.int64]:
        """(n,) row."""
        return self.footage.events["y"].astype(np.int64)

    @property
    def pixel(self) -> NDArray[np.int64]:
        """(n,) row-major index."""
        events = self.footage.events
        pixel: NDArray[np.int64] = events["y"].astype(np.int64) * self.footage.width + events["x"]
        return pixel

    @cached_property
    def nearest_frame(self) -> NDArray[np.int64]:
        """(n,): the frame nearest to each event; -1 if it is half a period away."""
        return np.where(np.abs(self.since_frame_us) < self.period_us / 2, self._nearest, -1)

    @cached_property
    def since_frame_us(self) -> NDArray[np.int64]:
        """(n,): from the time of the nearest frame to the event, negative before it."""
        return self.t_us - self.light.t_us[self._nearest]

    @cached_property
    def _nearest(self) -> NDArray[np.int64]:
        frames = self.light.t_us
        after = np.clip(np.searchsorted(frames, self.t_us), 1, len(frames) - 1)
        before = self.t_us - frames[after - 1] < frames[after] - self.t_us
        return np.where(before, after - 1, after)

    @cached_property
    def all_counts(self) -> NDArray[np.int64]:
        """(H, W): how many events each pixel has."""
        return self.counts(np.ones(self.t_us.size, np.bool_))

    def counts(self, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
        """(H, W): how many of the chosen events each pixel has."""
        size = (self.footage.height, self.footage.width)
        return np.bincount(self.pixel[chosen], minlength=size[0] * size[1]).reshape(size)


def subject_of(footage: Footage) -> Subject:
    """Needs two frames or more, of the events' size: ValueError."""
    if len(footage.frames) < 2:
        raise ValueError("a recording of one frame: give one with more")
    if footage.frames.shape[1:] != (footage.height, footage.width):
        raise ValueError("frames and events of different sizes")
    light = light_change_of(footage.frames, footage.frame_t_us)
    events = footage.events
    interval = np.searchsorted(footage.frame_t_us, events["t"], side="right") - 1
    interval[(interval >= len(footage.frame_t_us) - 1)] = -1
    at_rest = light.at_rest[interval, events["y"], events["x"]] & (interval >= 0)
    return Subject(footage, light, interval, at_rest)
