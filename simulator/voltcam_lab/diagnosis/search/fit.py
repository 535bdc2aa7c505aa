"""A hypothesis fitted to the measured statistics, by simulation with common noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values
from .hypothesis import BASE, Hypothesis
from .robust import mean_huber, robust_fit
from .spread import Slopes, flat, slopes_of
from .state import Search


@dataclass(frozen=True, eq=False)
class FitPoint:
    """A hypothesis, the statistics it gives on average, and the gap it leaves in the training parts."""

    hypothesis: Hypothesis
    mean: Values
    gap: float


def fitted_by_simulation(
    search: Search, hypothesis: Hypothesis, sd: Values, rounds: int, slopes: Slopes | None = None
) -> tuple[Hypothesis, Values]:
    """The hypothesis moved to the least gap in the training parts, in units of sd (PARTS, n), and the
    statistics that it gives on average.

    Gauss and Newton's method. slopes: to begin with, as far as they are known; they are taken from runs in
    each of `rounds` then, which is most of the time. Between these, each point that is tried mends them
    (Broyden 1965). It stops early in the curved valleys in which base parameters stand in for an effect: so
    the effect's size is moved too, the base following.
    """
    settings, point = search.settings, _point(search, sd, hypothesis)
    if slopes is not None:
        point = _Fit(search, sd, slopes).lowest(point)
    for _ in range(rounds):
        at_first = point.gap
        slopes = slopes_of(search.rig, point.hypothesis, settings.runs.slopes, settings)
        point = _Fit(search, sd, slopes).lowest(point)
        if at_first - point.gap < settings.fit.least_round_gain:
            break
    return point.hypothesis, point.mean


def _point(search: Search, sd: Values, hypothesis: Hypothesis) -> FitPoint:
    mean = search.rig.means([hypothesis.parameters()], search.settings.runs.fitting)[0]
    return FitPoint(hypothesis, mean, mean_huber(flat((search.data - mean) / sd), search.settings.huber_z))


@dataclass(eq=False)
class _Fit:
    """A descent. slopes: what is known of them, better with each point that is tried."""

    search: Search
    sd: Values
    slopes: Slopes

    def lowest(self, best: FitPoint) -> FitPoint:
        """Where it ends."""
        return self._resized(self._descended(best))

    def _tried(self, best: FitPoint, move: Values) -> FitPoint:
        """A point beside the best one; the slopes along the way to it are then as they are."""
        there = _point(self.search, self.sd, best.hypothesis.moved(move))
        length2 = float(move @ move)
        if length2 > self.search.settings.fit.shortest_secant**2:
            missed = there.mean - best.mean - self.slopes @ move
            self.slopes = self.slopes + missed[..., None] * (move / length2)
        return there

    @property
    def _columns(self) -> NDArray[np.float64]:
        return flat(self.slopes / self.sd[..., None])

    def _z(self, point: FitPoint) -> NDArray[np.float64]:
        return flat((self.search.data - point.mean) / self.sd)

    def _amounts(self, z: Values, columns: NDArray[np.float64], at: FitPoint) -> NDArray[np.float64]:
        """Where straight lines have the first parameters, one for each column, for the least loss."""
        settings = self.search.settings
        prior_sd = at.hypothesis.prior_sd(settings)[: columns.shape[1]]
        return robust_fit(z, columns, prior_sd, settings.huber_z, settings.fit.reweightings).x

    def _step(self, z: Values, columns: NDArray[np.float64], at: FitPoint) -> NDArray[np.float64]:
        """The same, no farther than a step may go."""
        longest = self.search.settings.fit.longest_step
        return np.clip(self._amounts(z, columns, at), -longest, longest)

    def _descended(self, best: FitPoint) -> FitPoint:
        """By steps to where straight lines have the least loss."""
        fit = self.search.settings.fit
        for _ in range(fit.descents):
            move = self._step(self._z(best), self._columns, best)
            tries = (self._tried(best, length * move) for length in fit.step_lengths)
            lower = next((one for one in tries if one.gap < best.gap), None)
            if lower is None:
                return best
            gained, best = best.gap - lower.gap, lower
            if gained < fit.least_gain:
                return best
        return best

    def _resized(self, best: FitPoint) -> FitPoint:
        """By other sizes of each effect, larger or smaller as straight lines have it; base parameters follow
        on these, and then once more from where they lead: valleys are curved."""
        base, fit = len(BASE), self.search.settings.fit
        for k in range(base, self.slopes.shape[-1]):
            side = np.sign(self._amounts(self._z(best), self._columns, best)[k])
            for step in side * np.array(fit.size_steps):
                columns, move = self._columns, np.zeros(self.slopes.shape[-1])
                move[k] = step
                move[:base] = self._step(self._z(best) - columns[:, k] * step, columns[:, :base], best)
                there = self._tried(best, move)
                move[:base] += self._step(self._z(there), self._columns[:, :base], there)
                lower = min(there, self._tried(best, move), key=lambda one: one.gap)
                if lower.gap < best.gap - fit.least_gain:
                    best = lower
                    break
        return best
