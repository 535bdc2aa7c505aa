"""A recording under examination: what every part of the report needs, worked out once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats import Recording
from voltcam_lab.health.light import Light, light_of


@dataclass(frozen=True, eq=False)
class Subject:
    """interval: (n,) the frame interval of each event, -1 before and after the frames. at_rest: (n,) whether
    the event's pixel is at rest then."""

    recording: Recording
    light: Light
    interval: NDArray[np.int64]
    at_rest: NDArray[np.bool_]

    @property
    def period_us(self) -> float:
        """Between frames."""
        return float(np.median(np.diff(self.light.t_us)))

    @property
    def t_us(self) -> NDArray[np.int64]:
        """(n,) of the events."""
        return self.recording.events["t"]

    @property
    def on(self) -> NDArray[np.bool_]:
        """(n,) polarity."""
        return self.recording.events["p"]

    @property
    def y(self) -> NDArray[np.int64]:
        """(n,) row."""
        return self.recording.events["y"].astype(np.int64)

    @property
    def pixel(self) -> NDArray[np.int64]:
        """(n,) row-major index."""
        events = self.recording.events
        pixel: NDArray[np.int64] = events["y"].astype(np.int64) * self.recording.width + events["x"]
        return pixel

    def counts(self, chosen: NDArray[np.bool_]) -> NDArray[np.int64]:
        """(H, W): how many of the chosen events each pixel has."""
        size = (self.recording.height, self.recording.width)
        return np.bincount(self.pixel[chosen], minlength=size[0] * size[1]).reshape(size)


def subject_of(recording: Recording) -> Subject:
    """Needs events, and two frames or more of the events' size: ValueError."""
    images, frame_t_us = recording.frames, recording.frame_t_us
    if images is None or frame_t_us is None or len(images) < 2:
        raise ValueError("a recording without frames: give one with frames and events")
    if images.shape[1:] != (recording.height, recording.width):
        raise ValueError("frames and events of different sizes")
    light = light_of(images, frame_t_us)
    events = recording.events
    interval = np.searchsorted(frame_t_us, events["t"], side="right") - 1
    interval[(interval >= len(frame_t_us) - 1)] = -1
    at_rest = light.at_rest[interval, events["y"], events["x"]] & (interval >= 0)
    return Subject(recording, light, interval, at_rest)


def within(t_us: NDArray[np.int64], windows: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(n,): whether t lies in one of the windows (M, 2), begin included, end not; sorted, not overlapping."""
    if len(windows) == 0:
        return np.zeros(t_us.size, np.bool_)
    before = np.searchsorted(windows[:, 0], t_us, side="right") - 1
    inside: NDArray[np.bool_] = (before >= 0) & (t_us < windows[before, 1])
    return inside
