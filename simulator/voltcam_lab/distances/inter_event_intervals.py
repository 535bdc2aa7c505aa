"""Distances between the times from event to event of a pixel."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.stats import wasserstein_distance

from voltcam_simulator.effect import Events

from ..light.frame_light import FrameLight
from ..light.known import KnownLight
from .region import Region

BINS_PER_DECADE = 10
FEWEST = 20
"""Intervals below which a group says nothing."""

Array = NDArray[np.float64]
Groups = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Intervals:
    """decades: (K,) log10 of the length [us]. group: (K,) what is compared apart from the rest. t_us (the
    middle), x, y: (K,)."""

    decades: Array
    group: Groups
    t_us: NDArray[np.int64]
    x: NDArray[np.uint16]
    y: NDArray[np.uint16]

    def where(self, chosen: NDArray[np.bool_]) -> Self:
        """Those chosen (K,) bool."""
        return type(self)(
            self.decades[chosen], self.group[chosen], self.t_us[chosen], self.x[chosen], self.y[chosen]
        )


def same_polarity(events: Events, region: Region, known: KnownLight | None = None) -> Intervals:
    """From each event to the next of its pixel and polarity; grouped by polarity. known: light in
    which all events are; intervals that other light is in between are left out."""
    return _intervals(events, region, known, apart=True)


def any_polarity(events: Events, region: Region, known: KnownLight | None = None) -> Intervals:
    """From each event to the next of its pixel; grouped by the pair of polarities, 2 * first + second.
    known: as in `same_polarity`."""
    return _intervals(events, region, known, apart=False)


def _intervals(events: Events, region: Region, known: KnownLight | None, apart: bool) -> Intervals:
    events = region.of(events)
    stretch = region.stretch_of(events["t"])
    pixel = events["y"].astype(np.int64) * region.pixels.shape[1] + events["x"]
    key = (pixel * len(region.times) + stretch) * 2 + (events["p"] if apart else 0)
    order = np.argsort(key, kind="stable")  # in order of time within a key
    first, last = order[:-1], order[1:]
    follows = key[first] == key[last]
    if known is not None:
        light = known.stretch(events)
        follows &= light[first] == light[last]
    first, last = first[follows], last[follows]
    span_us = events["t"][last] - events["t"][first]
    p = events["p"].astype(np.int64)
    return Intervals(
        decades=np.log10(np.maximum(span_us, 1)),
        group=p[last] if apart else 2 * p[first] + p[last],
        t_us=events["t"][first] + span_us // 2,
        x=events["x"][last],
        y=events["y"][last],
    )


def wasserstein(a: Intervals, b: Intervals) -> float:
    """Wasserstein distance [decades] of each group, weighted by the group's share. NaN without intervals."""
    return _over_groups(a, b, lambda first, last: float(wasserstein_distance(first, last)))


def total_variation(a: Intervals, b: Intervals) -> float:
    """Total variation, 0 to 1, in bins of a tenth of a decade; by groups as `wasserstein`."""
    return _over_groups(a, b, _variation)


def _variation(a: Array, b: Array) -> float:
    first, last = _histogram(a), _histogram(b)
    return 0.5 * float(np.abs(first - last).sum())


def _histogram(decades: Array) -> Array:
    """Shares in bins of a tenth of a decade from 1 us on."""
    bins = np.minimum((decades * BINS_PER_DECADE).astype(np.int64), 99)
    return np.bincount(bins, minlength=100) / max(decades.size, 1)


def _over_groups(a: Intervals, b: Intervals, distance: Callable[[Array, Array], float]) -> float:
    total = weights = 0.0
    for group in np.union1d(a.group, b.group):
        first, last = a.decades[a.group == group], b.decades[b.group == group]
        if min(first.size, last.size) >= FEWEST:
            weight = first.size / a.decades.size + last.size / b.decades.size
            total += weight * distance(first, last)
            weights += weight
    return total / weights if weights else float("nan")


@dataclass(frozen=True, eq=False)
class IntervalStrata:
    """Terciles of brightness [DN] and of |d ln L / dt| [1/s] over the intervals of real events."""

    light: FrameLight
    brightness_dn: Array
    speed_per_s: Array

    @classmethod
    def of(cls, real: Intervals, light: FrameLight) -> Self:
        """The terciles of these intervals."""
        thirds = (1 / 3, 2 / 3)
        where = (real.t_us, real.x, real.y)
        if not real.decades.size:
            return cls(light, np.zeros(2), np.zeros(2))
        brightness, speed = light.brightness(*where), light.speed(*where)
        return cls(light, np.quantile(brightness, thirds), np.quantile(speed, thirds))

    def numbers(self, intervals: Intervals) -> tuple[Groups, Groups]:
        """(K,) tercile of brightness and (K,) tercile of change, each 0 to 2."""
        where = (intervals.t_us, intervals.x, intervals.y)
        brightness = np.searchsorted(self.brightness_dn, self.light.brightness(*where))
        return brightness, np.searchsorted(self.speed_per_s, self.light.speed(*where))


def stratified_variation(a: Intervals, b: Intervals, strata: IntervalStrata) -> float:
    """Mean of `total_variation` over three terciles of brightness and three of change; NaN where none has
    intervals enough."""
    each = [
        total_variation(a.where(first == tercile), b.where(last == tercile))
        for first, last in zip(strata.numbers(a), strata.numbers(b), strict=True)
        for tercile in range(3)
    ]
    known = [value for value in each if not np.isnan(value)]
    return float(np.mean(known)) if known else float("nan")
