"""Noise by brightness: what a recording tells of it, and what that says of k3 and k6.

sigma = k3 sqrt(L)/(L + k2) + k6 (Eq. 11) is all that events see. How strong it is where it is bright, and how
much stronger where it is dim, are found nearly independently and with nearly normal errors; k3 and k6, each
the small difference of large numbers, are not. So the first two are fitted, and made k3 and k6 at the end.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ..light.grey import USUAL_DARK_DN

USUAL = (1e-4, 1e-5)  # k3, k6
USUAL_SD = 1.0  # of their logarithms
DIM_DN, BRIGHT_DN = 20.0, 200.0  # where noise is named, for a usual k2: any would do

Vector = NDArray[np.float64]
_DIM, _BRIGHT = (float(np.sqrt(level) / (level + USUAL_DARK_DN)) for level in (DIM_DN, BRIGHT_DN))
LARGEST_RATIO = _DIM / _BRIGHT  # without k6; without k3 it is 1


def ratio_of(k3: float, k6: float) -> tuple[float, float]:
    """(sigma where it is bright, that where it is dim in units of it)."""
    bright = _BRIGHT * k3 + k6
    return bright, (_DIM * k3 + k6) / bright


def split(bright: float, ratio: float) -> tuple[float, float]:
    """k3 and k6, one of which is negative where `ratio` is not in 1..LARGEST_RATIO."""
    k3 = bright * (ratio - 1) / (_DIM - _BRIGHT)
    return k3, bright - _BRIGHT * k3


@dataclass(frozen=True)
class Shares:
    """k3 and k6 as far as they are known: median, sd of the logarithm, 90 % interval; and how the logarithms
    are correlated."""

    value: tuple[float, float]
    sd: tuple[float, float]
    interval: tuple[tuple[float, float], tuple[float, float]]
    correlation: float


def shares(found: Vector, covariance: NDArray[np.float64], centre: Vector, prior_sd: Vector) -> Shares:
    """k3 and k6, neither negative, with their own priors, from logarithms `found` (2,) of bright noise and of
    its ratio, normal with `covariance`, in which independent priors (`centre`, `prior_sd`) had a part that is
    taken out again.

    Where k6 has a share s of the bright noise, the priors of k3 and k6 are flat in logit s and normal in the
    logarithm of the noise, given s: that integral is done by hand, the one over s by sum.
    """
    precision = np.linalg.inv(covariance) - np.diag(prior_sd**-2.0)
    values, vectors = np.linalg.eigh(precision)
    precision = (vectors * np.maximum(values, 0)) @ vectors.T
    pull = (found - centre) / prior_sd**2
    logit = np.linspace(-10, 10, 4001)
    share = 1 / (1 + np.exp(-logit))
    of_k3, of_k6 = np.log((1 - share) / _BRIGHT), np.log(share)  # of a bright noise of 1
    off = np.log(1 + (1 - share) * (LARGEST_RATIO - 1)) - found[1]
    # log density as -a n^2/2 + b n + c, n the logarithm of the bright noise less found[0]
    priors = [found[0] + of_k3 - np.log(USUAL[0]), found[0] + of_k6 - np.log(USUAL[1])]
    a = precision[0, 0] + 2 / USUAL_SD**2
    b = pull[0] - precision[0, 1] * off - (priors[0] + priors[1]) / USUAL_SD**2
    c = pull[1] * off - 0.5 * precision[1, 1] * off**2
    c -= 0.5 * (priors[0] ** 2 + priors[1] ** 2) / USUAL_SD**2
    weight = c + 0.5 * b * b / a
    nodes = ndtri((np.arange(31) + 0.5) / 31)
    n = found[0] + (b / a)[:, None] + nodes / np.sqrt(a)
    each = np.repeat(np.exp(weight - weight.max()), len(nodes))
    points = np.stack([(n + of_k3[:, None]).ravel(), (n + of_k6[:, None]).ravel()])
    spread = np.cov(points, aweights=each)
    ends = [_quantiles(row, each) for row in points]
    return Shares(
        value=(ends[0][1], ends[1][1]),
        sd=(float(np.sqrt(spread[0, 0])), float(np.sqrt(spread[1, 1]))),
        interval=((ends[0][0], ends[0][2]), (ends[1][0], ends[1][2])),
        correlation=float(spread[0, 1] / np.sqrt(spread[0, 0] * spread[1, 1])),
    )


def _quantiles(log: Vector, weight: Vector) -> tuple[float, float, float]:
    """At 5, 50 and 95 %, no logarithms any more."""
    order = np.argsort(log)
    below = np.cumsum(weight[order]) / weight.sum()
    low, middle, high = np.exp(log[order][np.searchsorted(below, (0.05, 0.5, 0.95))]).tolist()
    return low, middle, high
