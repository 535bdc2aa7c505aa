"""A log ratio of two densities as a sum of free functions of binned covariates: logistic regression.

The generalised additive model of Hastie and Tibshirani (1986) on one-hot bins, by local scoring: one function
after the other, as often as it takes. Label true against false, both weighed alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

ROUNDS = 60
SETTLED = 1e-6  # nats an event that a round still gains
RIDGE = 2.0  # events' worth of belief that a bin makes no difference
LONGEST_STEP = 1.0  # nats, of Newton's method where a bin is empty of one kind

Array = NDArray[np.float64]
Bins = NDArray[np.int64]
Labels = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Additive:
    """functions: for each covariate the log ratio in each of its bins [nats]."""

    functions: tuple[Array, ...] = ()

    def log_ratio(self, covariates: Sequence[Bins], count: int) -> Array:
        """(count,): of each event, from its bin of each covariate."""
        total = np.zeros(count)
        for function, bins in zip(self.functions, covariates, strict=True):
            total += function[bins]
        return total

    def and_then(self, further: "Additive") -> Self:
        """With the functions of a model of more covariates behind."""
        return type(self)((*self.functions, *further.functions))


def balanced(real: Labels) -> Array:
    """(n,): weights that give both kinds half of the whole, which is n."""
    share = np.count_nonzero(real) / max(real.size, 1)
    return np.where(real, 0.5 / max(share, 1e-12), 0.5 / max(1 - share, 1e-12))


def gain(log_ratio: Array, real: Labels) -> float:
    """Nats an event by which these log ratios tell real from simulated better than a coin; below 0: worse."""
    loss = np.logaddexp(0.0, np.where(real, -log_ratio, log_ratio))
    return float(np.log(2.0) - np.average(loss, weights=balanced(real)))


def fit(
    covariates: Sequence[Bins], sizes: Sequence[int], real: Labels, known: Array | None = None
) -> Additive:
    """The log ratio of the densities of real and simulated events over these covariates.

    covariates: for each (n,) its bin, 0 to size - 1. known: (n,) log ratio that stays as it is, and to which
    the functions are added.
    """
    weight, wanted = balanced(real), real.astype(np.float64)
    score = np.zeros(len(real)) if known is None else known.copy()
    functions = [np.zeros(size) for size in sizes]
    for _ in range(ROUNDS):
        gained = 0.0
        for function, bins in zip(functions, covariates, strict=True):
            chance = 1 / (1 + np.exp(-score))
            slope = np.bincount(bins, weight * (wanted - chance), function.size) - RIDGE * function
            curve = np.bincount(bins, weight * chance * (1 - chance), function.size) + RIDGE
            step = np.clip(slope / curve, -LONGEST_STEP, LONGEST_STEP)
            function += step
            score += step[bins]
            gained += float(step @ slope) / 2
        if gained < SETTLED * len(real):
            break
    return Additive(tuple(functions))
