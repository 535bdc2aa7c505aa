"""Leak rate against temperature: the paper's temperature figure, on Arrhenius' axes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.effects.junction_leak import ZERO_C_IN_K

from ...pages.style import GREEN, ORANGE, PURPLE, styled
from .noise import still_noise_rates

Array = NDArray[np.float64]
COLOURS = (PURPLE, GREEN, ORANGE)


@dataclass(frozen=True)
class LeakByTemperature:
    """A uniform image of `intensity_dn`, held for `seconds` before side x side pixels at each temperature."""

    intensity_dn: float = 128.0
    side: int = 64
    seconds: float = 20.0
    temperatures_c: tuple[float, ...] = (-20, -10, 0, 10, 20, 30, 40, 50, 60, 70, 80)


def leak_by_temperature(set_up: LeakByTemperature, parameters: Parameters, seed: int = 1) -> Array:
    """ON events a second and pixel at each temperature, by the exact law."""
    image = np.full((set_up.side, set_up.side), set_up.intensity_dn, np.float32)
    rates = []
    for temperature_c in set_up.temperatures_c:
        warm = parameters.changed({"temperature_c": temperature_c})
        simulator = Simulator(set_up.side, set_up.side, warm, seed=seed)
        simulator.advance(image, 0)
        events = simulator.advance(image, round(set_up.seconds * 1e6))
        rates.append(np.count_nonzero(events["p"]) / set_up.side**2 / set_up.seconds)
    return np.array(rates)


@styled
def temperature(set_up: LeakByTemperature, measured: Mapping[str, tuple[Parameters, Array]]) -> Figure:
    """measured: title -> (its parameters, rates of `leak_by_temperature`). The line is the closed form."""
    figure = Figure((5.6, 3.9), layout="constrained")
    axes = figure.subplots()
    fine_c = np.linspace(set_up.temperatures_c[0], set_up.temperatures_c[-1], 200)
    for (title, (parameters, rates)), colour in zip(measured.items(), COLOURS, strict=False):
        line = [
            still_noise_rates(parameters.changed({"temperature_c": c}), np.array([set_up.intensity_dn]))[0][0]
            for c in fine_c
        ]
        axes.plot(_inverse(fine_c), line, color=colour)
        axes.plot(
            _inverse(np.array(set_up.temperatures_c)), rates, "o", color=colour, markersize=5, label=title
        )
    axes.set_yscale("log")
    axes.set_xlabel("1000 / temperature [1/K]")
    axes.set_ylabel("leak: ON events / s / pixel")
    axes.invert_xaxis()  # warm to the right
    axes.grid(True)
    axes.legend(loc="upper left")
    above = axes.secondary_xaxis("top", functions=(_celsius, _inverse))
    above.set_xticks([-20, 0, 20, 40, 60, 80])
    above.set_xlabel("temperature [°C]")
    return figure


def _inverse(celsius: Any) -> Any:
    return 1000.0 / (celsius + ZERO_C_IN_K)


def _celsius(inverse: Any) -> Any:
    return 1000.0 / np.maximum(inverse, 1e-6) - ZERO_C_IN_K
