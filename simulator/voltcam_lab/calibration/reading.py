"""What of a recording is fitted: which events, pixels, times, and what the light did."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..light.scene import ENOUGH_EACH, TOLERANCES, TRUSTED, Scene
from ..windows import Mask, Windows
from .intervals import Intervals, intervals
from .rest import NO_WAITS, Rest, Waits, rest_of, waits

ENOUGH = 2_000  # intervals with an event: with as many, no more light is trusted than that


@dataclass(frozen=True, eq=False)
class Reading:
    """events (EVENT), sorted by time; the light; pixels to use (H, W); times to leave out: a Mask, or windows
    (M, 2) [us] of all rows. tolerance: of the light, as `Scene.trusted`. rest, and the pixels (H, W) whose
    waits for a first event at rest count: none where it is not given."""

    events: NDArray[np.void]
    scene: Scene
    keep: NDArray[np.bool_]
    masked: Mask | Windows
    tolerance: float = TRUSTED
    rest: Rest | None = None
    resting: NDArray[np.bool_] | None = None

    def intervals(self, dead_us: float, delay_us: float) -> Intervals:
        """Its same-pixel intervals."""
        return intervals(self.events, self.scene, self.keep, self.masked, dead_us, delay_us, self.tolerance)

    def waits(self) -> Waits:
        """For how long its pixels at rest had no event."""
        if self.rest is None or self.resting is None:
            return NO_WAITS
        return waits(self.events, self.rest, self.resting, self.masked)

    def prepared(self) -> "Reading":
        """The same with its pixels at rest, and as little trust in the light as leaves enough to fit."""
        found = replace(self, rest=rest_of(self.scene), resting=self.keep)
        for tolerance in TOLERANCES:
            found = replace(found, tolerance=tolerance)
            end = found.intervals(0.0, 0.0)["end"]
            if np.count_nonzero(end) >= ENOUGH and min(np.sum(end > 0), np.sum(end < 0)) >= ENOUGH_EACH:
                break
        return found

    def sampled(self, rng: np.random.Generator, size: int, still: int = 0) -> "Reading":
        """Pixels with about `size` intervals, alike many where the light hardly moves, moves, and moves much;
        and up to `still` more of the first, which alone tell of noise."""
        seen = self.intervals(0.0, 0.0)
        count = np.bincount(seen["pixel"][seen["end"] != 0], minlength=self.keep.size)
        moved = self.scene.images.std(axis=0).ravel()
        usable = np.flatnonzero(self.keep.ravel() & (count > 0))
        keep = np.zeros(count.size, np.bool_)
        parts = np.array_split(usable[np.argsort(moved[usable], kind="stable")], 3)
        for part, most in zip(parts, (size / 3 + still, size / 3, size / 3), strict=True):
            drawn = rng.permutation(part)
            keep[drawn[np.cumsum(count[drawn]) <= most]] = True
        return replace(self, keep=keep.reshape(self.keep.shape))
