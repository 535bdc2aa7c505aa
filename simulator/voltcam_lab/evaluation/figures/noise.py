"""Noise of a sensor that looks at a held image, by intensity: the paper's Fig. 6, with the closed form."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voltcam_simulator import Parameters
from voltcam_simulator.effects.junction_leak import arrhenius

from ...distances import NoiseRates
from ...models.model import Model
from ...pages.style import OFF, ON, REAL, colours, styled

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldImage:
    """A ramp of `intensities` grey levels in columns, `rows` pixels each, held for `seconds` at `fps`."""

    intensities: int = 64
    rows: int = 192
    seconds: float = 20.0
    fps: float = 30.0

    @property
    def levels_dn(self) -> Array:
        """(intensities,) 2 to 255 DN."""
        return np.linspace(2, 255, self.intensities)

    def rates(self, model: Model) -> tuple[Array, Array]:
        """(ON, OFF) events a second and pixel, (intensities,) each, of a model of intensities x rows."""
        image = np.tile(self.levels_dn.astype(np.float32), (self.rows, 1))
        on, off = np.zeros(self.intensities), np.zeros(self.intensities)
        for number in range(round(self.seconds * self.fps) + 1):
            events = model.advance(image, round(number * 1e6 / self.fps))
            columns = events["x"].astype(np.int64)
            on += np.bincount(columns[events["p"]], minlength=self.intensities)
            off += np.bincount(columns[~events["p"]], minlength=self.intensities)
        pixel_seconds = self.rows * self.seconds
        return on / pixel_seconds, off / pixel_seconds


def still_noise_rates(parameters: Parameters, intensity_dn: Array) -> tuple[Array, Array]:
    """(ON, OFF) events a second and pixel of the paper's Eq. 10 and 11 in still light, by the exact law.

    Brownian motion with drift m and standard deviation s leaves the band (-b, a) from 0 at +a with
    probability P = (1 - e^(-2cb)) / (1 - e^(-2c(a+b))), c = m / s^2, after (a P - b (1 - P)) / m on average,
    and begins anew (Karlin and Taylor, A First Course in Stochastic Processes, 7.5). Of the effects, only
    those equations' five and the thresholds count.
    """
    p = parameters
    leak = p.junction_leak.k4_per_us * arrhenius(p.temperature_c, p.junction_leak.activation_energy_ev)
    m = leak + p.parasitic_photocurrent.k5_per_dn_us * intensity_dn
    s = (
        p.photon_noise.k3 * np.sqrt(intensity_dn) / (intensity_dn + p.contrast_response.k2_dn)
        + p.leak_noise.k6
    )
    a, b = p.comparator.theta_on, p.comparator.theta_off
    c = np.maximum(m / s**2, 1e-9)
    up = np.expm1(-2 * c * b) / np.expm1(-2 * c * (a + b))
    down = np.exp(-2 * c * b) * np.expm1(-2 * c * a) / np.expm1(-2 * c * (a + b))  # 1 - up, which cancels
    mean_us = (a * up - b * down) / (c * s**2)
    return 1e6 * up / mean_us, 1e6 * down / mean_us


@styled
def noise_against_intensity(
    held: HeldImage, panels: Mapping[str, tuple[Parameters, Mapping[str, tuple[Array, Array]]]]
) -> Figure:
    """panels: title -> (parameters for the line, {model: its (ON, OFF) rates on the held image})."""
    figure = Figure((4.4 * len(panels), 3.7), layout="constrained")
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for panel, (title, (parameters, measured)) in zip(axes, panels.items(), strict=True):
        _panel(panel, held, parameters, measured)
        panel.set_title(title)
    axes[0].set_ylabel("noise events / s / pixel")
    found = [panel.get_legend_handles_labels() for panel in axes]
    legend = {
        label: handle for handles, labels in found for handle, label in zip(handles, labels, strict=True)
    }
    figure.legend(legend.values(), legend.keys(), loc="outside lower center", ncols=3 * len(panels))
    return figure


def _panel(
    panel: Axes, held: HeldImage, parameters: Parameters, measured: Mapping[str, tuple[Array, Array]]
) -> None:
    fine = np.linspace(1, 255, 400)
    least = 0.4 / (held.rows * held.seconds)
    markers = dict(zip(measured, ("o", "x", "^", "s"), strict=False))
    for name, (on, off) in measured.items():
        for rates, colour, polarity in ((on, ON, "ON"), (off, OFF, "OFF")):
            seen = rates > 0
            if seen.any():
                panel.plot(
                    held.levels_dn[seen], rates[seen], markers[name], color=colour, markersize=4,
                    alpha=0.75, markerfacecolor="none" if name != "exact" else colour,
                    markeredgewidth=1, label=f"{polarity}, {name}",
                )  # fmt: skip
    for rates, colour, polarity in zip(
        still_noise_rates(parameters, fine), (ON, OFF), ("ON", "OFF"), strict=True
    ):
        shown = np.where(rates > least, rates, np.nan)
        if not np.isnan(shown).all():
            panel.plot(fine, shown, color=colour, label=f"{polarity}, closed form", zorder=3)
    panel.set_yscale("log")
    panel.set_xlabel("intensity [DN]")
    panel.grid(True)


@styled
def noise_in_recording(real: NoiseRates, simulated: Mapping[str, NoiseRates]) -> Figure:
    """ON and OFF rates in still light by brightness, real beside models."""
    figure = Figure((8.8, 3.6), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    centres = (real.edges_dn[1:] + real.edges_dn[:-1]) / 2
    colour = colours(list(simulated))
    floor = 0.5 / max(float(real.pixel_seconds.sum()), 1.0)
    for panel, polarity in zip(axes, ("on", "off"), strict=True):
        for name, rates in {"real": real, **simulated}.items():
            values = np.where(getattr(rates, polarity) > floor, getattr(rates, polarity), np.nan)
            own = {"color": REAL, "linewidth": 3, "zorder": 4} if name == "real" else {"color": colour[name]}
            panel.plot(centres, values, "o-", markersize=4, label=name, **own)
        panel.set_yscale("log")
        panel.set_title(f"{polarity.upper()} events")
        panel.set_xlabel("brightness [DN]")
        panel.grid(True)
    axes[0].set_ylabel("events / s / pixel in still light")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
