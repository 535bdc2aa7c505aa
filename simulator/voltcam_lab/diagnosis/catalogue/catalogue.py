"""Effects that may be missing, each at sizes it may have."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, log, nextafter
from typing import Any

from pydantic.fields import FieldInfo

from voltcam_simulator import Parameters
from voltcam_simulator.effects.temperature_drift import COLDEST_C, HOTTEST_C

WEAKER = ("cutoff_hz", "max_rate_events_per_s")
"""Sizes that make an effect weaker when they grow."""
SCALED = (
    ("contrast_response", "k1"),
    ("photon_noise", "k3"),
    ("junction_leak", "k4_per_us"),
    ("parasitic_photocurrent", "k5_per_dn_us"),
    ("leak_noise", "k6"),
)
"""What is in units of the thresholds."""
TURNS = 0.25  # of a lamp, for a logarithm of 1: a step of 0.15 is 14 degrees
RATIOS = ("ratio", "gamma_exponent")
"""Sizes that are 1 where there is no effect."""


def limited(parameters: Parameters, changes: Mapping[str, Mapping[str, Any]]) -> Parameters:
    """The parameters changed, numbers kept inside the registry's limits: a fit knows of none."""
    return parameters.changed(
        {
            effect: {name: _limited(fields[name], value) for name, value in values.items()}
            for effect, values in changes.items()
            for fields in [type(getattr(parameters, effect)).model_fields]
        }
    )


def _limited(parameter: FieldInfo, value: Any) -> Any:
    value = _clipped(parameter, value)
    return round(value) if parameter.annotation is int else value


def _clipped(parameter: FieldInfo, value: Any) -> Any:
    for limit in parameter.metadata:
        value = max(value, getattr(limit, "ge", -inf), nextafter(getattr(limit, "gt", -inf), inf))
        value = min(value, getattr(limit, "le", inf))
    return value


@dataclass(frozen=True)
class Candidate:
    """An effect that is off in the model, and how to switch it on.

    sizes: where it is looked for, each one number for each of `names`; others are found by fitting, with the
    same sign. others: what goes with it. least: of the first number; less than one pixel is no share of them.
    """

    effect: str
    names: tuple[str, ...]
    sizes: tuple[tuple[float, ...], ...]
    others: Mapping[str, Any] = field(default_factory=dict)
    least: float = 0.0

    def scaled(self, size: tuple[float, ...], amount: float) -> tuple[float, ...]:
        """The size at which the effect is about `amount` times as strong."""
        if self.names[0] in RATIOS:
            return (size[0] ** amount, *size[1:])
        return (size[0] / amount if self.names[0] in WEAKER else size[0] * amount, *size[1:])

    def times(self, size: tuple[float, ...]) -> float:
        """How many times as strong as the strongest that it is looked for at."""
        here, there = size[0], [one[0] for one in self.sizes]
        if self.names[0] in RATIOS:
            return min(log(here) / log(one) for one in there if log(one) * log(here) >= 0)
        return min(one / here if self.names[0] in WEAKER else here / one for one in there if one * here > 0)

    def possible(self, size: tuple[float, ...]) -> bool:
        """Whether there is such a size: a fit that wants another form ends beyond the registry's limits."""
        fields = type(getattr(Parameters(), self.effect)).model_fields
        known = (
            (fields[name], value) for name, value in zip(self.names, size, strict=True) if name in fields
        )
        return abs(size[0]) >= self.least and all(_clipped(one, value) == value for one, value in known)

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with the effect at a size (one number for each name)."""
        values = dict(zip(self.names, size, strict=True))
        return limited(parameters, {self.effect: {**self.others, **values}})


@dataclass(frozen=True)
class Asymmetry(Candidate):
    """Unequal thresholds: their ratio is the size, their product stays.

    Gain, leaks and noise go with theta_on, so that ON events stay as they are: those at rest tell so sharply
    of theta_on over the leak that one cannot be moved without the other.
    """

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with theta_on/theta_off times the size."""
        now, up = parameters.comparator, size[0] ** 0.5
        changes = {"comparator": {"theta_on": now.theta_on * up, "theta_off": now.theta_off / up}}
        for effect, name in SCALED:
            changes[effect] = {name: getattr(getattr(parameters, effect), name) * up}
        return limited(parameters, changes)


@dataclass(frozen=True)
class Lamp(Candidate):
    """Flicker: its depth, and the phase as TURNS times the logarithm of the second size, beside a first
    guess: where events of the camera file's model come when those of the recording do."""

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with flicker of a depth and phase."""
        turns = self.others["phase_turns"] + TURNS * log(size[1])
        there = {**self.others, "depth": size[0], "phase_turns": turns - round(turns)}
        return limited(parameters, {self.effect: there})


@dataclass(frozen=True)
class Warming(Candidate):
    """A temperature that passes the camera file's in the middle of the recording, `seconds` long.

    Were it that at the start, leaks would be larger on average; what the base has is fitted to their mean.
    """

    seconds: float = field(kw_only=True)

    def on(self, parameters: Parameters, size: tuple[float, ...]) -> Parameters:
        """The parameters with a warming, and the temperature from which it begins."""
        start_c = parameters.temperature_c - 0.5 * size[0] * self.seconds
        start_c = min(max(start_c, COLDEST_C), HOTTEST_C)
        return super().on(parameters, size).changed({"temperature_c": start_c})


@dataclass(frozen=True)
class Clues:
    """What a recording tells of effects that have a clock or a place of their own."""

    seconds: float
    peak_rate_per_s: float
    flicker_hz: float
    frame_period_us: float
    exposure_us: float
    row_us: float
    rows: int
    exposure_start_us: float
    quantum_us: int
    pixels: int


def _one(name: str, *sizes: float) -> dict[str, Any]:
    return {"names": (name,), "sizes": tuple((size,) for size in sizes)}


def catalogue(clues: Clues) -> tuple[Candidate, ...]:
    """What is looked for, at sizes that a recording of seconds shows plainly."""
    warming = 10 * log(2) / log(2.03) / clues.seconds  # doubles the leak over the recording
    scan = {
        "frame_period_us": clues.frame_period_us,
        "exposure_us": clues.exposure_us,
        "row_us": clues.row_us,
        "offset_us": clues.exposure_start_us - clues.rows * clues.row_us,
    }
    scans, until_read = ((0.03, 0.03), (-0.03, -0.03)), ((0.03, -0.03, 300), (-0.03, 0.03, 300))
    warmings = _one("rate_c_per_s", warming, 2.3 * warming, -warming)
    a_pixel = 1 / clues.pixels
    usb = {"buffer_events": 64}
    lamp = {"frequency_hz": clues.flicker_hz, "phase_turns": 0.0}
    return (
        Candidate("refractory_period", **_one("period_us", 700, 3000)),
        Candidate("photoreceptor_bandwidth", ("cutoff_hz", "follower_hz"), ((400, 3200), (80, 640))),
        Asymmetry("comparator", **_one("ratio", 1.15, 1 / 1.15)),
        Lamp("flicker", ("depth", "advance"), ((0.02, 1.0), (0.05, 1.0)), lamp),
        Candidate("aps_coupling", **_one("exposure_kick", 0.03, -0.03), others=scan),
        Candidate("aps_coupling", ("readout_kick", "reset_kick"), scans, others=scan),
        Candidate("aps_coupling", ("exposure_kick", "readout_kick", "line_us"), until_read, others=scan),
        Candidate("latency", ("delay_us", "jitter_us"), ((200, 200), (1200, 1200))),
        Candidate("latency", **_one("delay_us", 1000, -1000)),
        Candidate("readout", **_one("event_us", 20, 60)),
        Candidate("hot_pixels", ("fraction", "rate_hz"), ((0.003, 20), (0.012, 20)), least=a_pixel),
        Candidate("low_light_shot_noise", **_one("c", 0.005, 0.012)),
        Candidate("threshold_mismatch", **_one("sigma", 0.07, 0.2)),
        Candidate("reset_noise", **_one("sigma", 0.1, 0.25)),
        Candidate("leak_mismatch", **_one("sigma", 0.3, 0.8)),
        Candidate("dead_pixels", **_one("fraction", 0.01), least=a_pixel),
        Warming("temperature_drift", **warmings, seconds=clues.seconds),
        Candidate("usb_overflow", **_one("max_rate_events_per_s", 0.4 * clues.peak_rate_per_s), others=usb),
        Candidate("crosstalk", **_one("coupling", 0.05)),
        Candidate("noise_pairs", **_one("rate_hz", 2)),
        Candidate("timestamp_quantum", **_one("quantum_us", max(clues.quantum_us, 2))),
        Candidate("vignetting", **_one("corner_loss", 0.3)),
        Candidate("exposure_blur", **_one("exposure_us", 5000)),
        Candidate("input_response", **_one("gamma_exponent", 0.8, 1.4)),
        Candidate("input_response", **_one("black_level_dn", 8)),
    )
