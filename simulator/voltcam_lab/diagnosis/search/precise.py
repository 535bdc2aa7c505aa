"""Where a model that is fitted already has its parameters for certain, and how certain that is."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..rig.rig import Rig, Values
from .model import Model, Spread, flat, slopes
from .robust import SOFT

SEEDS = range(8)  # of slopes
FURTHEST = 0.5  # of a logarithm: fits by simulation end nearer
ROUNDS = 5


@dataclass(frozen=True, eq=False)
class Precise:
    """covariance: (k, k) of the model's `shift`, at most the prior's."""

    model: Model
    covariance: NDArray[np.float64]


def precise(rig: Rig, model: Model, spread: Spread, data: Values | None = None) -> Precise:
    """The model moved to the least loss on straight lines through its twins (not at all without data).

    Fits compare means of four runs, whose noise hides what is less than some standard deviations; the mean of
    all twins and slopes of more seeds tell more. Statistics are not independent of each other, so the
    covariance is H^-1 (J + R) H^-1, H = C'C + R, R the prior, J the covariance of the score C'z over twins.
    """
    columns = flat(slopes(rig, model, SEEDS) / spread.lenient[..., None])
    prior = np.diag(model.prior_sd**-2.0)
    z = np.zeros(len(columns)) if data is None else flat((data - spread.mean) / spread.lenient)
    weight, x = np.ones(len(z)), np.zeros(columns.shape[1])
    for _ in range(ROUNDS):
        hessian = columns.T @ (columns * weight[:, None]) + prior
        x = np.clip(np.linalg.solve(hessian, columns.T @ (weight * z)), -FURTHEST, FURTHEST)
        weight = 1 / np.sqrt(1 + ((z - columns @ x) / SOFT) ** 2)
    inverse = np.linalg.inv(columns.T @ (columns * weight[:, None]) + prior)
    scores = [columns.T @ (weight * flat((twin - spread.mean) / spread.lenient)) for twin in spread.twins]
    scattered = np.cov(np.transpose(scores)) * (1 + 1 / len(spread.twins))
    found = inverse @ (scattered + prior) @ inverse
    within = np.minimum(model.prior_sd / np.sqrt(np.diag(found)), 1.0)
    moved = replace(model, shift=tuple((np.array(model.shift) + x).tolist()))
    return Precise(moved, np.asarray(found * np.outer(within, within)))
