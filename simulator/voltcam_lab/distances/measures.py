"""All measures at once: real against simulated events, and real against real."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..dependence.covariates import Look
from ..dependence.told_apart import told_apart
from ..light.frame_light import FrameLight
from ..windows import within
from . import counts, patches
from . import inter_event_intervals as intervals
from .frame_phase import phase_shares, phase_variation
from .region import BLOCK_US, Region, by_pixels, by_time


@dataclass(frozen=True)
class Measure:
    """A line of the table: what it is called, its unit, and what is best (None: whatever the real one is)."""

    name: str
    title: str
    unit: str
    best: float | None


MEASURES = {
    measure.name: measure
    for measure in (
        Measure("W1", "intervals: Wasserstein", "decades", 0),
        Measure("TV", "intervals: total variation", "1", 0),
        Measure("TVs", "the same by brightness and change", "1", 0),
        Measure("pair", "lag by polarity pair: Wasserstein", "decades", 0),
        Measure("b4", "4x4-block counts in 50 ms: correlation", "1", 1),
        Measure("AUC", "patches told apart by a classifier", "1", 0.5),
        Measure("nats", "told apart by stamps and addresses, held out", "nats/event", 0),
        Measure("phase", "phase from frame to frame: total variation", "1", 0),
        Measure("noise", "noise rate by brightness: mean difference", "events/s/pixel", 0),
        Measure("on", "ON rate", "events/s/pixel", None),
        Measure("off", "OFF rate", "events/s/pixel", None),
        Measure("ratio", "ON/OFF ratio", "1", None),
        Measure("quiet_on", "ON rate in still light", "events/s/pixel", None),
        Measure("dispersion", "spread over pixels beyond Poisson (CV)", "1", None),
    )
}
HEADLINES = ("W1", "TVs", "pair", "b4", "AUC")
DISTANCES = tuple(name for name, measure in MEASURES.items() if measure.best is not None)


@dataclass(frozen=True, eq=False)
class Yardstick:
    """Real events, and where and in what light other events of the same scene are held against them."""

    real: Events
    region: Region
    light: FrameLight

    def distances(self, simulated: Events) -> dict[str, float]:
        """All of MEASURES for events of the same sensor and scene."""
        region = self.region
        same = self._same, intervals.same_polarity(simulated, region)
        return {
            "W1": intervals.wasserstein(*same),
            "TV": intervals.total_variation(*same),
            "TVs": intervals.stratified_variation(*same, self._strata),
            "pair": intervals.wasserstein(self._any, intervals.any_polarity(simulated, region)),
            "b4": counts.correlation(
                self._images, counts.count_images(simulated, region), counts.watched(region)
            ),
            "AUC": patches.auc(self.real, simulated, region),
            "nats": told_apart(self.real, [simulated], self._look, self._judged(region)).total,
            "phase": phase_variation(self._phases, phase_shares(simulated, region, self.light)),
            "noise": counts.noise_difference(self.noise(), counts.noise_rates(simulated, region, self.light)),
            **self.figures(simulated),
        }

    def figures(self, events: Events) -> dict[str, float]:
        """Those of MEASURES that belong to events by themselves; region and light are this one's."""
        return _figures(events, self.region, self.light)

    def noise(self) -> counts.NoiseRates:
        """The real events' rates in still light."""
        return counts.noise_rates(self.real, self.region, self.light)

    def floor_by_pixels(self) -> dict[str, float]:
        """Real against real: every other pixel, as a checkerboard, against the rest (AUC, dispersion: tiles).

        b4 is stepped up by Spearman and Brown's formula from halves of the pixels to all of them; a figure's
        entry is how far the two halves are apart.
        """
        first, second = by_pixels(self.region, tile=1)
        half = counts.correlation(
            counts.count_images(self.real, first),
            counts.count_images(self.real, second),
            counts.watched(self.region),
        )
        tiles = by_pixels(self.region, patches.TILE_PIXELS)
        spread = [counts.dispersion(self.real, half) for half in tiles]
        own = {
            "b4": 2 * half / (1 + half),
            "AUC": patches.auc_of_halves(self.real, tiles),
            "dispersion": abs(spread[0] - spread[1]),
        }
        return self._between(first, second) | own

    def floor_by_time(self) -> dict[str, float]:
        """Real against real: every other 100 ms against the rest; there is no b4."""
        halves = by_time(self.region, BLOCK_US)
        return self._between(*halves) | {"AUC": patches.auc_of_halves(self.real, halves)}

    def _judged(self, region: Region) -> Callable[[Events], NDArray[np.bool_]]:
        def judged(events: Events) -> NDArray[np.bool_]:
            inside: NDArray[np.bool_] = region.pixels[events["y"], events["x"]]
            return inside & within(events["t"], region.live)

        return judged

    def _between(self, first: Region, second: Region) -> dict[str, float]:
        real, light = self.real, self.light
        same = intervals.same_polarity(real, first), intervals.same_polarity(real, second)
        figures = _figures(real, first, light), _figures(real, second, light)
        return {
            "W1": intervals.wasserstein(*same),
            "TV": intervals.total_variation(*same),
            "TVs": intervals.stratified_variation(*same, self._strata),
            "pair": intervals.wasserstein(
                intervals.any_polarity(real, first), intervals.any_polarity(real, second)
            ),
            "phase": phase_variation(phase_shares(real, first, light), phase_shares(real, second, light)),
            "noise": counts.noise_difference(
                counts.noise_rates(real, first, light), counts.noise_rates(real, second, light)
            ),
        } | {name: abs(figures[0][name] - figures[1][name]) for name in figures[0]}

    @cached_property
    def _same(self) -> intervals.Intervals:
        return intervals.same_polarity(self.real, self.region)

    @cached_property
    def _any(self) -> intervals.Intervals:
        return intervals.any_polarity(self.real, self.region)

    @cached_property
    def _strata(self) -> intervals.IntervalStrata:
        return intervals.IntervalStrata.of(self._same, self.light)

    @cached_property
    def _phases(self) -> NDArray[np.float64]:
        return phase_shares(self.real, self.region, self.light)

    @cached_property
    def _look(self) -> Look:
        height, width = self.region.pixels.shape
        return Look.at(self.region.of(self.real), width, height, self.light)

    @cached_property
    def _images(self) -> counts.Counts:
        return counts.count_images(self.real, self.region)


def _figures(events: Events, region: Region, light: FrameLight) -> dict[str, float]:
    on, off = counts.rates(events, region)
    return {
        "on": on,
        "off": off,
        "ratio": on / off if off else float("nan"),
        "quiet_on": counts.quiet_on_rate(events, region, light),
        "dispersion": counts.dispersion(events, region),
    }


def gap(name: str, value: float, floor: float) -> float:
    """How far a distance is from its floor, in its own unit; 0 at the floor or nearer. NaN stays NaN."""
    best = MEASURES[name].best or 0.0
    return max(0.0, abs(value - best) - abs(floor - best)) if value == value else value


def closest(table: Mapping[str, Mapping[str, float]], name: str) -> str | None:
    """The model of a table {model: distances} with the least distance; None where none is known."""
    best = MEASURES[name].best or 0.0
    known = {model: abs(row[name] - best) for model, row in table.items() if row[name] == row[name]}
    return min(known, key=known.__getitem__) if known else None
