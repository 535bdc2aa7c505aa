"""A hypothesis fitted to the measured statistics, by simulation with common noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values
from .hypothesis import BASE, Hypothesis
from .robust import mean_huber, robust_fit
from .spread import flat, slopes_of
from .state import Search


@dataclass(frozen=True, eq=False)
class FitPoint:
    """A hypothesis, the statistics it gives on average, and the gap it leaves in the training parts."""

    hypothesis: Hypothesis
    mean: Values
    gap: float


def fitted_by_simulation(
    search: Search, hypothesis: Hypothesis, sd: Values, rounds: int
) -> tuple[Hypothesis, Values]:
    """The hypothesis moved to the least gap in the training parts, in units of sd (PARTS, n), and the
    statistics that it gives on average.

    Gauss and Newton's method; slopes are taken anew in each round. It stops early in the curved valleys in
    which base parameters stand in for an effect: so the effect's size is moved too, the base following.
    """
    fit, settings = _Fit(search, sd), search.settings
    best = fit.point(hypothesis)
    for _ in range(rounds):
        slopes = slopes_of(search.rig, best.hypothesis, settings.runs.slopes, settings)
        at_first, columns = best.gap, flat(slopes / sd[..., None])
        best = fit.resized(fit.descended(best, columns), columns)
        if at_first - best.gap < settings.fit.least_round_gain:
            break
    return best.hypothesis, best.mean


@dataclass(frozen=True, eq=False)
class _Fit:
    search: Search
    sd: Values

    def point(self, hypothesis: Hypothesis, move: NDArray[np.float64] | float = 0.0) -> FitPoint:
        moved = hypothesis.moved(move)
        mean = self.search.rig.means([moved.parameters()], self.search.settings.runs.fitting)[0]
        return FitPoint(moved, mean, mean_huber(self.z(mean), self.search.settings.huber_z))

    def z(self, mean: Values) -> NDArray[np.float64]:
        return flat((self.search.data - mean) / self.sd)

    def amounts(self, z: Values, columns: NDArray[np.float64], at: FitPoint) -> NDArray[np.float64]:
        """Where straight lines have the first parameters, one for each column, for the least loss."""
        settings = self.search.settings
        prior_sd = at.hypothesis.prior_sd(settings)[: columns.shape[1]]
        return robust_fit(z, columns, prior_sd, settings.huber_z, settings.fit.reweightings).x

    def step(self, z: Values, columns: NDArray[np.float64], at: FitPoint) -> NDArray[np.float64]:
        """The same, no farther than a step may go."""
        longest = self.search.settings.fit.longest_step
        return np.clip(self.amounts(z, columns, at), -longest, longest)

    def descended(self, best: FitPoint, columns: NDArray[np.float64]) -> FitPoint:
        """By steps to where straight lines have the least loss."""
        fit = self.search.settings.fit
        for _ in range(fit.descents):
            move = self.step(self.z(best.mean), columns, best)
            tries = (self.point(best.hypothesis, length * move) for length in fit.step_lengths)
            lower = next((one for one in tries if one.gap < best.gap), None)
            if lower is None:
                return best
            gained, best = best.gap - lower.gap, lower
            if gained < fit.least_gain:
                return best
        return best

    def resized(self, best: FitPoint, columns: NDArray[np.float64]) -> FitPoint:
        """By other sizes of each effect, larger or smaller as straight lines have it; base parameters follow
        on these, and then once more from where they lead: valleys are curved."""
        base, fit = len(BASE), self.search.settings.fit
        of_base = columns[:, :base]
        for k in range(base, columns.shape[1]):
            side = np.sign(self.amounts(self.z(best.mean), columns, best)[k])
            for step in side * np.array(fit.size_steps):
                move = np.zeros(columns.shape[1])
                move[k] = step
                move[:base] = self.step(self.z(best.mean) - columns[:, k] * step, of_base, best)
                there = self.point(best.hypothesis, move)
                move[:base] += self.step(self.z(there.mean), of_base, there)
                lower = min(there, self.point(best.hypothesis, move), key=lambda one: one.gap)
                if lower.gap < best.gap - fit.least_gain:
                    best = lower
                    break
        return best
