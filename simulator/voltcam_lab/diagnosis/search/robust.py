"""Robust linear fits of a gap."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
SOFT = 5.0  # z from which a deviation counts less than its square


def gap(z: Vector) -> float:
    """G: mean pseudo-Huber loss of deviations z, about 0.5 for chance alone."""
    return float(loss(z).mean())


def loss(z: Vector) -> Vector:
    """z^2/2 for small z, SOFT |z| for large ones."""
    return SOFT**2 * (np.sqrt(1 + (z / SOFT) ** 2) - 1)


@dataclass(frozen=True, eq=False)
class Fitted:
    """x: (k,) amounts; gain: by how much the summed loss falls against x = 0, prior included; rest: z
    left."""

    x: Vector
    gain: float
    rest: Vector


def fitted(z: Vector, columns: NDArray[np.float64], prior_sd: Vector, steps: int = 8) -> Fitted:
    """Amounts x of columns (n, k) that leave the least loss of z - columns x, with x ~ N(0, prior_sd^2)."""
    x: Vector = np.zeros(columns.shape[1])
    before = float(loss(z).sum())
    ridge = np.diag(prior_sd**-2.0)
    for _ in range(steps):
        weight = 1 / np.sqrt(1 + ((z - columns @ x) / SOFT) ** 2)
        weighted = columns * weight[:, None]
        x = np.linalg.solve(columns.T @ weighted + ridge, weighted.T @ z).astype(np.float64)
    rest = z - columns @ x
    after = float(loss(rest).sum() + 0.5 * ((x / prior_sd) ** 2).sum())
    return Fitted(x, before - after, rest)
