"""Whose events networks are trained on: all see the same scenes."""

from collections.abc import Callable

import numpy as np

from voltcam_lab.models.esim import Esim, EsimParameters
from voltcam_lab.models.model import Model
from voltcam_lab.models.v2e import V2e
from voltcam_simulator import Parameters, Simulator

Sensor = Callable[[int, int, float, np.random.Generator], Model]

OURS, PAPER, ESIM, V2E, NO_NOISE = "exact, calibrated", "paper, as published", "esim", "v2e", "no noise"
WITHOUT = "exact, without "

WORDS = {
    OURS: "preset `davis240c`: Voltcam's exact law, as calibrated on the first 60 % of `slider_depth`",
    PAPER: "preset `paper`: DVS-Voltmeter's Algorithm 1 with its published parameters (Lin et al., ECCV "
    "2022)",
    ESIM: "threshold crossing of ln light between frames (Rebecq et al., CoRL 2018), thresholds drawn for "
    "each clip from N(0.18, 0.03) as E2VID was trained (Rebecq et al., CVPR 2019)",
    V2E: "v2e with the defaults of its emulator class (Hu, Liu, Delbruck, CVPRW 2021)",
    NO_NOISE: "preset `ideal`: contrast and equal thresholds, nothing else",
}

OFF: dict[str, dict[str, dict[str, float]]] = {
    "refractory period": {"refractory_period": {"period_us": 0}},
    "photoreceptor bandwidth": {"photoreceptor_bandwidth": {"cutoff_hz": 0}},
    "unequal thresholds": {"comparator": {"theta_on": 1.0, "theta_off": 1.0}},
    "reset noise": {"reset_noise": {"sigma": 0}},
    "low-light shot noise": {"low_light_shot_noise": {"c": 0}},
    "Brownian noise": {"photon_noise": {"k3": 0}, "leak_noise": {"k6": 0}},
    "latency": {"latency": {"delay_us": 0, "jitter_us": 0}},
}
"""The ablation: what of the calibrated camera is taken away, one at a time."""

MODELS = (OURS, PAPER, ESIM, V2E, NO_NOISE)
ABLATIONS = tuple(WITHOUT + name for name in OFF)


def sensor_of(name: str) -> Sensor:
    """Raises KeyError for an unknown name."""
    if name == ESIM:
        return _esim
    if name == V2E:
        return lambda width, height, _, rng: V2e(width, height, seed=_seed(rng))
    if name.startswith(WITHOUT):
        return _ours(Parameters.of("davis240c").changed(OFF[name.removeprefix(WITHOUT)]))
    return {
        OURS: _ours(Parameters.of("davis240c")),
        PAPER: lambda width, height, _, rng: Simulator(
            width, height, Parameters.of("paper"), "paper", _seed(rng), 1
        ),
        NO_NOISE: _ours(Parameters.of("ideal")),
    }[name]


def _ours(parameters: Parameters) -> Sensor:
    return lambda width, height, _, rng: Simulator(width, height, parameters, "exact", _seed(rng), 1)


def _esim(width: int, height: int, _: float, rng: np.random.Generator) -> Model:
    theta_on, theta_off = np.maximum(rng.normal(0.18, 0.03, 2), 0.05).tolist()
    return Esim(width, height, EsimParameters(theta_on=theta_on, theta_off=theta_off), _seed(rng))


def _seed(rng: np.random.Generator) -> int:
    return int(rng.integers(2**31))
