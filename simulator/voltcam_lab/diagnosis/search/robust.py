"""The gap of a model, and linear fits that lessen it: Huber's loss in its smooth form."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values


def mean_huber(z: Values, huber_z: float) -> float:
    """The gap: mean pseudo-Huber loss of deviations z, about 0.5 for chance alone."""
    return float(huber(z, huber_z).mean())


def huber(z: Values, huber_z: float) -> Values:
    """z^2/2 for small z, huber_z |z| for large ones."""
    return huber_z**2 * (np.sqrt(1 + (z / huber_z) ** 2) - 1)


def huber_weight(z: Values, huber_z: float) -> Values:
    """The weights with which weighted squares have the same slope as the loss at z."""
    weight: Values = 1 / np.sqrt(1 + (z / huber_z) ** 2)
    return weight


@dataclass(frozen=True, eq=False)
class RobustFit:
    """x: (k,) amounts; gain: by how much the summed loss falls against x = 0, prior included; rest: z
    left."""

    x: Values
    gain: float
    rest: Values


def robust_fit(
    z: Values, columns: NDArray[np.float64], prior_sd: Values, huber_z: float, rounds: int,
    limit: float = np.inf, first_weight: Values | None = None,
) -> RobustFit:  # fmt: skip
    """Amounts x of columns (n, k) that leave the least loss of z - columns x, with x ~ N(0, prior_sd^2).

    Iteratively reweighted least squares. limit: of |x|, in each round. first_weight: (n,) of the first round;
    None: those of z.
    """
    x: Values = np.zeros(columns.shape[1])
    before = float(huber(z, huber_z).sum())
    ridge = np.diag(prior_sd**-2.0)
    weight = huber_weight(z, huber_z) if first_weight is None else first_weight
    for _ in range(rounds):
        weighted = columns * weight[:, None]
        x = np.linalg.solve(columns.T @ weighted + ridge, weighted.T @ z).astype(np.float64)
        x = np.clip(x, -limit, limit)
        weight = huber_weight(z - columns @ x, huber_z)
    rest = z - columns @ x
    after = float(huber(rest, huber_z).sum() + 0.5 * ((x / prior_sd) ** 2).sum())
    return RobustFit(x, before - after, rest)
