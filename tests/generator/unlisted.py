"""Effects in nobody's catalogue: the right answer to them is "unknown", or a formula for the drift."""

from collections.abc import Callable
from typing import Any

import numpy as np

from .wires import Wires, radiances

SIZES: dict[str, tuple[float, float, float]] = {
    "dark_drift": (0.3, 0.8, 2.0),  # thresholds/s at 20 DN, as 1/(L+L0)^p, either direction
    "root_drift": (0.3, 0.8, 2.0),  # OFF thresholds/s at 128 DN, as sqrt(L)
    "column_drift": (0.3, 0.8, 2.0),  # thresholds/s at the right edge, minus it at the left
    "rebound": (0.1, 0.2, 0.4),  # thresholds that return, against the event, after it
    "tiring_threshold": (0.03, 0.08, 0.2),  # rise of the thresholds by an event, relative
    "threshold_ripple": (0.03, 0.08, 0.2),  # amplitude, relative, of all thresholds at once
    "row_shadow": (50, 200, 800),  # us in which neighbouring rows lose OFF events after an ON event
    "after_events": (0.03, 0.1, 0.25),  # chance of an event to be followed by another of its kind
    "dim_refractory": (1000, 3000, 9000),  # us at 20 DN, as 1/L
    "slew_limit": (500, 150, 50),  # 1/s: the rate of d ln(L+k2)/dt that passes by half
    "striped_thresholds": (0.05, 0.12, 0.3),  # of rows or columns, in bands that take turns, relative
}

Parameters = dict[str, float]
Generator = np.random.Generator

DRAW: dict[str, Callable[[Generator, float], dict[str, Any]]] = {
    "dark_drift": lambda rng, size: {
        "per_s": size * rng.choice([-1, 1]),
        "l0_dn": rng.uniform(5, 30),
        "power": rng.uniform(1, 2),
    },
    "root_drift": lambda rng, size: {"per_s": -size},
    "column_drift": lambda rng, size: {"per_s": size * rng.choice([-1, 1])},
    "rebound": lambda rng, size: {"voltage": size, "tau_us": np.exp(rng.uniform(np.log(5e3), np.log(5e4)))},
    "tiring_threshold": lambda rng, size: {"rise": size, "tau_us": rng.uniform(2e4, 1e5)},
    "threshold_ripple": lambda rng, size: {"depth": size, "frequency_hz": rng.uniform(3, 40)},
    "row_shadow": lambda rng, size: {"shadow_us": size},
    "after_events": lambda rng, size: {"chance": size, "mean_us": rng.uniform(200, 1500)},
    "dim_refractory": lambda rng, size: {"period_us": size, "at_dn": 20},
    "slew_limit": lambda rng, size: {"per_s": size},
    "striped_thresholds": lambda rng, size: {
        "depth": size,
        "band_px": rng.integers(1, 9),
        "of_rows": rng.integers(2),
    },
}


def _dark_drift(wires: Wires, p: Parameters, rng: Generator) -> None:
    shape = ((20 + p["l0_dn"]) / (radiances() + p["l0_dn"])) ** p["power"]
    wires.tables.leak_per_us[:] += 1e-6 * p["per_s"] * shape


def _root_drift(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.tables.leak_per_us[:] += 1e-6 * p["per_s"] * np.sqrt(radiances() / 128)


def _column_drift(wires: Wires, p: Parameters, rng: Generator) -> None:
    ramp = np.linspace(-1, 1, wires.shape[1])
    wires.maps.drift_per_us[:] += 1e-6 * p["per_s"] * ramp


def _ripple(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.theta *= 1 + p["depth"] * np.sin(2e-6 * np.pi * p["frequency_hz"] * wires.t_us)


def _stripes(wires: Wires, p: Parameters, rng: Generator) -> None:
    y, x = np.indices(wires.shape)
    band = (y if p["of_rows"] else x) // p["band_px"] % 2
    factor = 1 + p["depth"] * (2 * band - 1)
    wires.maps.theta_on[:] *= factor
    wires.maps.theta_off[:] *= factor


def _dim_refractory(wires: Wires, p: Parameters, rng: Generator) -> None:
    wires.tables.refractory_us[:] += p["period_us"] * p["at_dn"] / np.maximum(radiances(), 5)


WIRE: dict[str, Callable[[Wires, Parameters, Generator], None]] = {
    "dark_drift": _dark_drift,
    "root_drift": _root_drift,
    "column_drift": _column_drift,
    "rebound": lambda wires, p, rng: wires.set(rebound=p["voltage"], rebound_us=p["tau_us"]),
    "tiring_threshold": lambda wires, p, rng: wires.set(tiring=p["rise"], tiring_us=p["tau_us"]),
    "threshold_ripple": _ripple,
    "dim_refractory": _dim_refractory,
    "slew_limit": lambda wires, p, rng: wires.set(slew_per_us=1e-6 * p["per_s"]),
    "striped_thresholds": _stripes,
}
