"""The gap of a model, and linear fits that lessen it: Huber's loss in its smooth form."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values

HUBER_Z = 5.0
"""z from which a deviation counts less than its square. It defines the gap, so no setting changes it.
Convention: single statistics cannot dominate, and chance alone is all below."""


def mean_huber(z: Values) -> float:
    """The gap: mean pseudo-Huber loss of deviations z, about 0.5 for chance alone."""
    return float(huber(z).mean())


def huber(z: Values) -> Values:
    """z^2/2 for small z, HUBER_Z |z| for large ones."""
    return HUBER_Z**2 * (np.sqrt(1 + (z / HUBER_Z) ** 2) - 1)


def huber_weight(z: Values) -> Values:
    """The weights with which weighted squares have the same slope as the loss at z."""
    weight: Values = 1 / np.sqrt(1 + (z / HUBER_Z) ** 2)
    return weight


@dataclass(frozen=True, eq=False)
class RobustFit:
    """x: (k,) amounts; gain: by how much the summed loss falls against x = 0, prior included; rest: z
    left."""

    x: Values
    gain: float
    rest: Values


def robust_fit(
    z: Values, columns: NDArray[np.float64], prior_sd: Values, rounds: int = 8, limit: float = np.inf,
    first_weight: Values | None = None,
) -> RobustFit:  # fmt: skip
    """Amounts x of columns (n, k) that leave the least loss of z - columns x, with x ~ N(0, prior_sd^2).

    Iteratively reweighted least squares. limit: of |x|, in each round. first_weight: (n,) of the first round;
    None: those of z.
    """
    x: Values = np.zeros(columns.shape[1])
    before = float(huber(z).sum())
    ridge = np.diag(prior_sd**-2.0)
    weight = huber_weight(z) if first_weight is None else first_weight
    for _ in range(rounds):
        weighted = columns * weight[:, None]
        x = np.linalg.solve(columns.T @ weighted + ridge, weighted.T @ z).astype(np.float64)
        x = np.clip(x, -limit, limit)
        weight = huber_weight(z - columns @ x)
    rest = z - columns @ x
    after = float(huber(rest).sum() + 0.5 * ((x / prior_sd) ** 2).sum())
    return RobustFit(x, before - after, rest)
