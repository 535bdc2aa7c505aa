"""The effects of the catalogue by the registry's names, at three levels.

Some change the pixels (`wire`), some the events (`readout.py`), one the frames' clock (`recording.py`).
Sizes are in the catalogue's units; how an effect comes about is our own choice where there is one. Leak
spread and temperature act on the junction's k4 alone (Eq. 4), a small part of the leak in bright light.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import root_scalar
from scipy.special import polygamma

from . import unlisted
from .wires import Floats, Wires, radiances

SIZES: dict[str, tuple[float, float, float]] = {
    "refractory_period": (700, 2000, 6000),  # us
    "photoreceptor_bandwidth": (300, 100, 30),  # Hz at 128 DN
    "comparator": (0.05, 0.15, 0.35),  # theta_on/theta_off - 1, or its inverse
    "flicker": (0.01, 0.025, 0.06),  # part of the light
    "aps_coupling": (0.01, 0.03, 0.08),  # thresholds
    "latency": (200, 600, 2000),  # us of jitter, s.d.
    "readout": (10, 25, 60),  # us per event
    "hot_pixels": (0.0015, 0.005, 0.015),  # part of the array
    "low_light_shot_noise": (0.003, 0.006, 0.012),  # c
    "threshold_mismatch": (0.05, 0.1, 0.2),  # s.d., relative
    "reset_noise": (0.08, 0.15, 0.28),  # s.d., thresholds
    "leak_mismatch": (0.3, 0.6, 1.0),  # s.d. of the logarithm of k4
    "dead_pixels": (0.003, 0.01, 0.03),  # part of the array
    "temperature_drift": (1.5, 2.5, 5),  # k4 at the end over k4 at the start
    # sizes of our own, the catalogue gives none:
    "usb_overflow": (0.01, 0.05, 0.2),  # part of the events to be lost in holes
    "crosstalk": (0.02, 0.05, 0.12),  # thresholds
    "noise_pairs": (0.15, 0.25, 0.4),  # s.d. at 50 DN, thresholds
    "timestamp_quantum": (20, 200, 1000),  # us
    "clock_offset": (500, 1500, 4000),  # us the frames' stamps are late
}
LISTED = tuple(SIZES)
UNLISTED = tuple(unlisted.SIZES)
LEVELS = ("weak", "medium", "strong")


@dataclass(frozen=True)
class Effect:
    name: str
    level: str
    parameters: dict[str, float]

    @property
    def listed(self) -> bool:
        """In the catalogue; otherwise the right answer is "unknown"."""
        return self.name in SIZES


def draw_effect(rng: np.random.Generator, name: str, level: str) -> Effect:
    """name: one of LISTED or UNLISTED; level: one of LEVELS. Side parameters are drawn."""
    sizes = {**SIZES, **unlisted.SIZES}
    if name not in sizes or level not in LEVELS:
        raise ValueError(f"no effect {name!r} at level {level!r}: take one of {sorted(sizes)} at {LEVELS}")
    size = float(sizes[name][LEVELS.index(level)])
    draw = DRAW.get(name) or unlisted.DRAW[name]
    return Effect(name, level, {key: float(value) for key, value in draw(rng, size).items()})


DRAW: dict[str, Callable[[np.random.Generator, float], dict[str, Any]]] = {
    "refractory_period": lambda rng, size: {"period_us": size},
    "photoreceptor_bandwidth": lambda rng, size: {"cutoff_hz": size, "at_dn": 128, "follower_hz": 8 * size},
    "comparator": lambda rng, size: {"ratio": (1 + size) ** rng.choice([-1, 1])},
    "flicker": lambda rng, size: {
        "depth": size,
        "frequency_hz": rng.choice([100, 120]) * (1 + 2e-4 * rng.uniform(-1, 1)),
        "phase": rng.uniform(0, 2 * np.pi),
    },
    "aps_coupling": lambda rng, size: {
        "kick": size,
        "exposure_us": rng.uniform(500, 1500),
        "pulse_us": rng.uniform(500, 1000),
        "row_us": 35.25,
    },
    "latency": lambda rng, size: {"jitter_us": size, "delay_us": rng.uniform(50, 300)},
    "readout": lambda rng, size: {"us_per_event": size},
    "hot_pixels": lambda rng, size: {"fraction": size, "mean_hz": rng.uniform(20, 60), "on_share": 0.95},
    "low_light_shot_noise": lambda rng, size: {"c": size, "dark_dn": rng.uniform(3, 8)},
    "threshold_mismatch": lambda rng, size: {"sigma": size, "log_normal": rng.integers(2)},
    "reset_noise": lambda rng, size: {"sigma": size},
    "leak_mismatch": lambda rng, size: {"sigma": size},
    "dead_pixels": lambda rng, size: {"fraction": size},
    "temperature_drift": lambda rng, size: {"factor": size},
    "usb_overflow": lambda rng, size: {"lost": size, "buffer_events": rng.integers(300, 800)},
    "crosstalk": lambda rng, size: {"kick": size},
    "noise_pairs": lambda rng, size: {"sigma": size, "corner_hz": rng.uniform(30, 100)},
    "timestamp_quantum": lambda rng, size: {"quantum_us": size},
    "clock_offset": lambda rng, size: {"offset_us": size * rng.choice([-1, 1]), "ppm": rng.uniform(-50, 50)},
}


def wire(wires: Wires, effect: Effect, rng: np.random.Generator) -> None:
    """Puts the effect into the pixels, where it lives there. rng: of its fixed pattern."""
    change = WIRE.get(effect.name) or unlisted.WIRE.get(effect.name)
    if change:
        change(wires, effect.parameters, rng)


Parameters = dict[str, float]
Generator = np.random.Generator


def _refractory(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.tables.refractory_us[:] += p["period_us"]


def _bandwidth(wires: Wires, p: Parameters, rng: Generator) -> None:
    speed = (0.1 + 0.9 * radiances() / 255) / (0.1 + 0.9 * p["at_dn"] / 255)  # v2e's rule
    wires.tables.cutoff_per_us[:] = 2e-6 * np.pi * p["cutoff_hz"] * speed
    wires.set(follower_per_us=2e-6 * np.pi * p["follower_hz"])


def _comparator(wires: Wires, p: Parameters, rng: Generator) -> None:
    root = np.sqrt(p["ratio"])
    wires.maps.theta_on[:] *= root
    wires.maps.theta_off[:] /= root


def _flicker(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.light *= 1 + p["depth"] * np.sin(2e-6 * np.pi * p["frequency_hz"] * wires.t_us + p["phase"])


def _aps(wires: Wires, p: Parameters, rng: Generator) -> None:
    half = p["exposure_us"] / 2  # stamps are those of mid-exposure
    wires.kick_us = np.column_stack([wires.frame_t_us - half, wires.frame_t_us + half]).astype(float)
    wires.set(kick=p["kick"], pulse_us=p["pulse_us"], row_us=p["row_us"])


def _shot_noise(wires: Wires, p: Parameters, rng: Generator) -> None:
    extra = p["c"] / (radiances() + p["dark_dn"])
    wires.tables.sigma[:] = np.hypot(wires.tables.sigma, extra)


def _threshold_mismatch(wires: Wires, p: Parameters, rng: Generator) -> None:
    def spread() -> Floats:
        xi = p["sigma"] * rng.standard_normal(wires.shape)
        return np.exp(xi) if p["log_normal"] else np.maximum(1 + xi, 0.2)

    for name in ("theta_on", "theta_off"):
        wires.patterns[f"{name}_factor"] = factor = spread()
        getattr(wires.maps, name)[:] *= factor


def _leak_mismatch(wires: Wires, p: Parameters, rng: Generator) -> None:
    """Gamma over the pixels, mean 1, with the asked spread of its logarithm."""
    shape = float(root_scalar(lambda k: polygamma(1, k) - p["sigma"] ** 2, bracket=(0.1, 1e4)).root)
    wires.patterns["leak_factor"] = factor = rng.gamma(shape, 1 / shape, wires.shape)
    wires.maps.junction_per_us[:] *= factor


def _temperature(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.junction *= p["factor"] ** np.clip(wires.t_us / wires.end_us, 0, 1)


def _noise_pairs(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.set(hum=p["sigma"], hum_us=1e6 / (2 * np.pi * p["corner_hz"]))


WIRE: dict[str, Callable[[Wires, Parameters, Generator], None]] = {
    "refractory_period": _refractory,
    "photoreceptor_bandwidth": _bandwidth,
    "comparator": _comparator,
    "flicker": _flicker,
    "aps_coupling": _aps,
    "low_light_shot_noise": _shot_noise,
    "threshold_mismatch": _threshold_mismatch,
    "reset_noise": lambda wires, p, rng: wires.set(reset_sigma=p["sigma"]),
    "leak_mismatch": _leak_mismatch,
    "temperature_drift": _temperature,
    "crosstalk": lambda wires, p, rng: wires.set(crosstalk=p["kick"]),
    "noise_pairs": _noise_pairs,
}
