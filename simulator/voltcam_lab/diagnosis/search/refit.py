"""A model fitted to what the battery saw, by simulation with common noise."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..rig.rig import Rig, Values
from .model import BASE, Model, flat, slopes
from .robust import fitted, gap

FURTHEST = 0.8  # of a logarithm, in one step
LENGTHS = (1.0, 0.4, 0.1)  # of a step, until one of them leads down
SIZES = (0.15, 0.5)  # of a logarithm: an effect's size is tried that much larger, or smaller
LITTLE = 0.005  # of the gap: less is not worth another step


@dataclass(frozen=True, eq=False)
class Place:
    """A model, what the battery sees of it on average, and the gap that it leaves in the training parts."""

    model: Model
    mean: Values
    gap: float


def refitted(
    rig: Rig, model: Model, data: Values, v: Values, seeds: Sequence[int], rounds: int = 1
) -> tuple[Model, Values]:
    """The model moved to where it is nearest to the data in the training parts, and what the battery sees of
    it on average.

    Gauss and Newton's method; slopes are taken anew in each round. It stops early in the curved valleys in
    which base parameters stand in for an effect: so the effect's size is moved too, the base following.
    """
    fit = _Fit(rig, data, v, seeds)
    best = fit.place(model)
    for _ in range(rounds):
        at_first, columns = best.gap, flat(slopes(rig, best.model) / v[..., None])
        best = fit.sized(fit.descended(best, columns), columns)
        if at_first - best.gap < 2 * LITTLE:
            break
    return best.model, best.mean


@dataclass(frozen=True, eq=False)
class _Fit:
    rig: Rig
    data: Values
    v: Values
    seeds: Sequence[int]

    def place(self, model: Model, move: NDArray[np.float64] | float = 0.0) -> Place:
        moved = replace(model, shift=tuple((np.array(model.shift) + move).tolist()))
        mean = self.rig.means([moved.parameters()], self.seeds)[0]
        return Place(moved, mean, gap(self.z(mean)))

    def z(self, mean: Values) -> NDArray[np.float64]:
        return flat((self.data - mean) / self.v)

    def descended(self, best: Place, columns: NDArray[np.float64]) -> Place:
        """By steps to where straight lines have the least loss."""
        for _ in range(3):
            move = fitted(self.z(best.mean), columns, best.model.prior_sd).x
            move = np.clip(move, -FURTHEST, FURTHEST)
            tries = (self.place(best.model, length * move) for length in LENGTHS)
            lower = next((one for one in tries if one.gap < best.gap), None)
            if lower is None:
                return best
            gained, best = best.gap - lower.gap, lower
            if gained < LITTLE:
                return best
        return best

    def sized(self, best: Place, columns: NDArray[np.float64]) -> Place:
        """By other sizes of each effect, larger or smaller as straight lines have it; base parameters follow
        on these, and then once more from where they lead: valleys are bent."""
        base = len(BASE)
        for k in range(base, columns.shape[1]):
            side = np.sign(fitted(self.z(best.mean), columns, best.model.prior_sd).x[k])
            for step in side * np.array(SIZES):
                move = np.zeros(columns.shape[1])
                move[k] = step
                move[:base] = self.follow(self.z(best.mean) - columns[:, k] * step, columns, best)
                there = self.place(best.model, move)
                move[:base] += self.follow(self.z(there.mean), columns, there)
                lower = min(there, self.place(best.model, move), key=lambda one: one.gap)
                if lower.gap < best.gap - LITTLE:
                    best = lower
                    break
        return best

    def follow(self, z: NDArray[np.float64], columns: NDArray[np.float64], at: Place) -> NDArray[np.float64]:
        """Where straight lines have base parameters for the least loss of z."""
        base = len(BASE)
        found = fitted(z, columns[:, :base], at.model.prior_sd[:base]).x
        return np.clip(found, -FURTHEST, FURTHEST)
