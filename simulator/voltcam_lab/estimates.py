"""Parameters of a camera with their intervals, and what each rests on: the recording, or what is usual."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from .fit import PRIOR_SD
from .likelihood import NAMES, START

PLACES = {
    "k1": ("contrast_response", "k1"),
    "k2_dn": ("contrast_response", "k2_dn"),
    "k3": ("photon_noise", "k3"),
    "k4_per_us": ("junction_leak", "k4_per_us"),
    "k5_per_dn_us": ("parasitic_photocurrent", "k5_per_dn_us"),
    "k6": ("leak_noise", "k6"),
    "threshold_spread": ("threshold_mismatch", "sigma"),
    "leak_spread": ("leak_mismatch", "sigma"),
    "reset_spread": ("reset_noise", "sigma"),
}
"""Where the parameters of the likelihood are in a camera file; the ratio of the thresholds aside."""

NORMAL_90 = 1.645
PAIRS = (("k1", "k2_dn"), ("k3", "k6"), ("k4_per_us", "k5_per_dn_us"))
"""Which of them a recording tells apart badly (DIAGNOSIS.md, section 4)."""


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

    @property
    def rests_on(self) -> str:
        """In a word: "data", "prior", or both."""
        return "data" if self.determined else "data and prior" if self.informed > 0.2 else "prior"


def parameters_of(values: dict[str, float], dead_us: float, delay_us: float) -> Parameters:
    """A camera's parameters from those of the likelihood (NAMES)."""
    changes: dict[str, dict[str, float]] = {}
    for name, (effect, parameter) in PLACES.items():
        changes.setdefault(effect, {})[parameter] = values[name]
    ratio = float(np.sqrt(values["on_over_off"]))
    changes["comparator"] = {"theta_on": ratio, "theta_off": 1 / ratio}
    changes["refractory_period"] = {"period_us": dead_us}
    changes["latency"] = {"delay_us": max(delay_us, 0.0)}
    return Parameters().changed(changes)


def estimates_of(log: NDArray[np.float64], sd: NDArray[np.float64]) -> tuple[Estimate, ...]:
    """Of the logarithms (k,) of the parameters NAMES and their standard deviations."""
    found = []
    for i, name in enumerate(NAMES):
        if name in PLACES:
            places = [(*PLACES[name], 1.0)]
        elif name == "on_over_off":
            places = [("comparator", "theta_on", 0.5), ("comparator", "theta_off", -0.5)]
        else:
            continue
        usual = np.log(START[name]) + NORMAL_90 * PRIOR_SD[name] * np.array([-1, 1])
        ends = log[i] + NORMAL_90 * sd[i] * np.array([-1, 1])
        informed = float(np.clip(1 - sd[i] / PRIOR_SD[name], 0, 1))
        for effect, parameter, power in places:
            low, high = sorted(np.exp(power * ends).tolist())
            first, last = sorted(np.exp(power * usual).tolist())
            value = float(np.exp(power * log[i]))
            found.append(Estimate(effect, parameter, value, low, high, (first, last), informed))
    return tuple(found)


def correlations(covariance: NDArray[np.float64]) -> dict[tuple[str, str], float]:
    """Of the logarithms of PAIRS, from the covariance (k, k)."""
    sd = np.sqrt(np.diag(covariance))
    places = [(NAMES.index(a), NAMES.index(b)) for a, b in PAIRS]
    return {
        pair: float(covariance[i, j] / (sd[i] * sd[j])) for pair, (i, j) in zip(PAIRS, places, strict=True)
    }
