"""How far simulated events are from a recording's, as one smooth number to be made small."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..light.frame_light import FrameLight
from ..light.known import KnownLight
from .counts import count_images, in_still_light, watched
from .inter_event_intervals import Intervals, IntervalStrata, any_polarity, same_polarity
from .region import Region

DECADES = (1.5, 7.5)
PER_DECADE = 10
REST = 0.2  # weight of noise: seldom much of what a camera gives out
TILE_PIXELS = 12
SHARED = 40.0  # weight of events that share their time with a neighbour: few, but they tell a camera

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Goal:
    """real: events of the recording, of which `region` is looked at, and there those that `known` light has
    made, if it is given. Light may go its own way between frames: what it does there must not be made up for.
    """

    real: Events
    region: Region
    light: FrameLight
    known: KnownLight | None = None

    def score(self, simulated: Events) -> float:
        """The sum of the squared `residuals`; 0 for the recording itself."""
        residuals = self.residuals(simulated)
        return float(residuals @ residuals)

    def residuals(self, simulated: Events) -> Vector:
        """(R,), as many for any simulation; 0 for the recording itself. What they are of:

        - intervals of a polarity by thirds of brightness and of change, and of any two polarities:
          differences of the roots of the counts, so rates count too, and of the cumulated shares;
        - 4 x 4-block counts in 50 ms, roots again;
        - ON and OFF events where light stands still;
        - the share of events that have their time in common with another one near them, in any light: stamps
          alone tell it.
        """
        everything, simulated = simulated, self.region.of(self._of_known_light(simulated))
        found = []
        for real, other in zip(self._histograms, self._histograms_of(simulated), strict=True):
            size = max(real.sum(), 50.0)
            found.append(2 * (_root(other) - _root(real)) / np.sqrt(size))
            found.append(np.cumsum(other / max(other.sum(), 1)) - np.cumsum(real / size))
        blocks = _root(count_images(simulated, self.region)[self._cells]) - self._blocks
        found.append(2 * blocks.ravel() / np.sqrt(max(blocks.size, 1)))
        rest, real_rest = (np.array(two, float) for two in (self._resting_of(simulated), self._resting))
        found.append(np.sqrt(REST / np.maximum(real_rest, 50.0)) * (np.sqrt(rest) - np.sqrt(real_rest)))
        apart = np.sqrt(_shared(everything, self.region)) - np.sqrt(self._shared)
        return np.concatenate([*found, [np.sqrt(SHARED) * apart]])

    def moving(self, simulated: Events) -> int:
        """How many events there are where light does not stand still."""
        events = self.region.of(self._of_known_light(simulated))
        return int(events.size - in_still_light(events, self.region, self.light).size)

    @cached_property
    def _real(self) -> Events:
        return self._of_known_light(self.real)

    def _of_known_light(self, events: Events) -> Events:
        if self.known is None:
            return events
        seen = self.known.where(events)
        settled: Events = seen.compress(self.known.settled(seen))
        return settled

    @cached_property
    def _same(self) -> Intervals:
        return same_polarity(self._real, self.region, self.known)

    @cached_property
    def _strata(self) -> IntervalStrata:
        return IntervalStrata.of(self._same, self.light)

    @cached_property
    def _histograms(self) -> list[Vector]:
        return self._histograms_of(self._real)

    def _histograms_of(self, events: Events) -> list[Vector]:
        same, pairs = (of(events, self.region, self.known) for of in (same_polarity, any_polarity))
        found = []
        for third in self._strata.numbers(same):
            for number in range(3):
                found += [_histogram(same.decades[(third == number) & (same.group == p)]) for p in (0, 1)]
        return found + [_histogram(pairs.decades[pairs.group == pair]) for pair in range(4)]

    @cached_property
    def _resting(self) -> tuple[int, int]:
        return self._resting_of(self._real)

    def _resting_of(self, events: Events) -> tuple[int, int]:
        events = in_still_light(events, self.region, self.light)
        on = int(np.count_nonzero(events["p"]))
        return on, len(events) - on

    @cached_property
    def _cells(self) -> NDArray[np.bool_]:
        return watched(self.region)

    @cached_property
    def _blocks(self) -> Vector:
        return _root(count_images(self._real, self.region)[self._cells])

    @cached_property
    def _shared(self) -> float:
        return _shared(self.real, self.region)


def _histogram(decades: Vector) -> Vector:
    low, high = (round(PER_DECADE * end) for end in DECADES)
    bins = np.clip((decades * PER_DECADE).astype(np.int64) - low, 0, high - low - 1)
    return np.bincount(bins, minlength=high - low).astype(np.float64)


def _root(counts: NDArray[np.generic]) -> Vector:
    roots: Vector = np.sqrt(counts.astype(np.float64) + 0.375)  # of counts: about the same spread at any rate
    return roots


def _shared(events: Events, region: Region) -> float:
    """Share of the events that come in the same microsecond as the one before them in a tile of pixels."""
    events = region.of(events)
    columns = -(-region.pixels.shape[1] // TILE_PIXELS)
    tile = events["y"].astype(np.int64) // TILE_PIXELS * columns + events["x"] // TILE_PIXELS
    order = np.argsort(tile, kind="stable")  # in order of time within a tile
    together = (np.diff(events["t"][order]) == 0) & (np.diff(tile[order]) == 0)
    return np.count_nonzero(together) / max(events.size, 1)
