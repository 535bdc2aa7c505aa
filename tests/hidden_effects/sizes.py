"""How large a hidden effect was in the registry's terms, and how large the diagnosis says it is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log, sqrt

from tests.generator import Effect

from .ask import Named
from .cases import HEIGHT, SECONDS, WIDTH

DARK_CARDS_DN = 10.0  # the darkest of the scenes, where low-light noise is seen
KELVIN, K_OVER_EA = 298.15, 8.617e-5 / 0.56  # of the junction leak: exp(-Ea/kT), about 25 C


@dataclass(frozen=True)
class Size:
    """The main parameter of an effect that was named: as hidden, and as found with its 90 % interval."""

    parameter: str
    true: float
    value: float
    low: float
    high: float


def _some(fraction: float) -> float:
    """Of the array: whole pixels, at least one."""
    return max(round(fraction * WIDTH * HEIGHT), 1) / (WIDTH * HEIGHT)


def _rise(inverse: float) -> float:
    """How far apart two temperatures are whose inverses differ by that, KELVIN in the middle between them."""
    return 2 * (sqrt(1 + (inverse * KELVIN) ** 2) - 1) / inverse


Truth = Callable[[dict[str, float]], float]
# The registry's parameters and what the generator's come to in them. Forms differ in part: that is intended.
TRUTHS: dict[str, dict[str, Truth]] = {
    "refractory_period": {"period_us": lambda p: p["period_us"]},
    # at 255 DN, growing with L + 20 (the generator: with L + 28.3); the same at 128 DN
    "photoreceptor_bandwidth": {"cutoff_hz": lambda p: p["cutoff_hz"] * (255 + 20) / (128 + 20)},
    "flicker": {"depth": lambda p: p["depth"]},
    "aps_coupling": {
        "exposure_kick": lambda p: p["kick"],
        "readout_kick": lambda p: -p["kick"],
        "reset_kick": lambda p: p["kick"],
    },
    "latency": {
        "jitter_us": lambda p: p["jitter_us"],
        "delay_us": lambda p: p["delay_us"],
    },
    "readout": {"event_us": lambda p: p["us_per_event"]},
    "hot_pixels": {"fraction": lambda p: _some(p["fraction"])},
    "low_light_shot_noise": {"c": lambda p: p["c"] * (DARK_CARDS_DN + 5) / (DARK_CARDS_DN + p["dark_dn"])},
    "threshold_mismatch": {"sigma": lambda p: p["sigma"]},
    "reset_noise": {"sigma": lambda p: p["sigma"]},
    "leak_mismatch": {"sigma": lambda p: p["sigma"]},
    "dead_pixels": {"fraction": lambda p: _some(p["fraction"])},
    "temperature_drift": {"rate_c_per_s": lambda p: _rise(K_OVER_EA * log(p["factor"])) / SECONDS},
}


def size_of(effect: Effect, named: Sequence[Named]) -> Size | None:
    """The first of an effect's parameters in TRUTHS that was estimated; None where none was."""
    estimates = {
        key: value for one in named if one.name == effect.name for key, value in one.parameters.items()
    }
    if effect.name == "comparator" and {"theta_on", "theta_off"} <= estimates.keys():
        on, off = estimates["theta_on"], estimates["theta_off"]
        return Size(
            "theta_on/theta_off", effect.parameters["ratio"], on.value / off.value, on.low / off.high,
            on.high / off.low,
        )  # fmt: skip
    for parameter, truth in TRUTHS.get(effect.name, {}).items():
        if parameter in estimates:
            one = estimates[parameter]
            return Size(parameter, truth(effect.parameters), one.value, one.low, one.high)
    return None
