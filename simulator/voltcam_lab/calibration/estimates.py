"""Parameters of a camera with their intervals, and what each rests on: the recording, or what is usual."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ..models.exact import K1_TO_K6, SPREADS
from .fit import NAMES, PRIOR, PRIOR_SD
from .likelihood import START
from .noise import USUAL_SD, Shares, shares

PLACES = K1_TO_K6 | SPREADS
"""Where the parameters of the likelihood are in a camera file; the ratio of the thresholds aside."""

NORMAL_90 = 1.645
PAIRS = (("k1", "k2_dn"), ("k4_per_us", "k5_per_dn_us"))
"""Which of them, beside k3 and k6, a recording tells apart badly."""


@dataclass(frozen=True)
class Estimate:
    """A parameter: value, 90 % interval, what is usual (the prior's 90 %), and the share of what is known of
    it that the recording gave: 1 - sd / prior sd of its logarithm."""

    effect: str
    parameter: str
    value: float
    low: float
    high: float
    usual: tuple[float, float]
    informed: float

    @property
    def determined(self) -> bool:
        """Whether the recording fixes it, rather than what is usual."""
        return self.informed > 0.5

    def reaching(self, value: float) -> "Estimate":
        """With an interval that has this value in it, too: where another way to ask gave it, the interval of
        the first way tells too little."""
        return replace(self, low=min(self.low, value), high=max(self.high, value))

    @property
    def rests_on(self) -> str:
        """In a word: "data", "prior", or both."""
        return "data" if self.determined else "data and prior" if self.informed > 0.2 else "prior"


def likelihood_parameters(values: dict[str, float], dead_us: float, delay_us: float) -> Parameters:
    """A camera's parameters from those of the likelihood (NAMES)."""
    changes: dict[str, dict[str, float]] = {}
    for name, (effect, parameter) in PLACES.items():
        changes.setdefault(effect, {})[parameter] = max(values[name], 0.0)  # k3 or k6, by rounding
    ratio = float(np.sqrt(values["on_over_off"]))
    changes["comparator"] = {"theta_on": ratio, "theta_off": 1 / ratio}
    changes["refractory_period"] = {"period_us": dead_us}
    changes["latency"] = {"delay_us": delay_us}
    return Parameters().changed(changes)


def noise_shares(log: NDArray[np.float64], covariance: NDArray[np.float64]) -> Shares:
    """k3 and k6 of logarithms (k,) of NAMES with their covariance (k, k)."""
    two = [NAMES.index("noise"), NAMES.index("noise_ratio")]
    return shares(log[two], covariance[np.ix_(two, two)], PRIOR.centre[two], PRIOR.sd[two])


def estimates_of(log: NDArray[np.float64], sd: NDArray[np.float64], noise: Shares) -> tuple[Estimate, ...]:
    """Of the logarithms (k,) of the parameters NAMES and their standard deviations; k3 and k6 of `noise`."""
    found = {}
    for i, name in enumerate(NAMES):
        if name in PLACES:
            found[name] = _estimate(*PLACES[name], log[i], sd[i], START[name], PRIOR_SD[name])
        elif name == "on_over_off":
            for which, sign in (("theta_on", 1), ("theta_off", -1)):
                half = sign * log[i] / 2, sd[i] / 2, 1.0, PRIOR_SD[name] / 2
                found[which] = _estimate("comparator", which, *half)
    for k, name in enumerate(("k3", "k6")):
        of = _estimate(*PLACES[name], np.log(noise.value[k]), noise.sd[k], START[name], USUAL_SD)
        low, high = noise.interval[k]
        found[name] = replace(of, low=low, high=high)
    order = [name for name in PLACES if name in found] + ["theta_on", "theta_off"]
    return tuple(found[name] for name in order)


def _estimate(effect: str, parameter: str, log: float, sd: float, usual: float, prior_sd: float) -> Estimate:
    ends = NORMAL_90 * np.array([-1, 1])
    low, high = np.exp(log + sd * ends).tolist()
    first, last = (usual * np.exp(prior_sd * ends)).tolist()
    informed = float(np.clip(1 - sd / prior_sd, 0, 1))
    return Estimate(effect, parameter, float(np.exp(log)), low, high, (first, last), informed)


def correlations(covariance: NDArray[np.float64], noise: Shares) -> dict[tuple[str, str], float]:
    """Of the logarithms of PAIRS, from the covariance (k, k), and of k3 and k6."""
    sd = np.sqrt(np.diag(covariance))
    places = [(NAMES.index(a), NAMES.index(b)) for a, b in PAIRS]
    found = {
        pair: float(covariance[i, j] / (sd[i] * sd[j])) for pair, (i, j) in zip(PAIRS, places, strict=True)
    }
    return found | {("k3", "k6"): noise.correlation}
