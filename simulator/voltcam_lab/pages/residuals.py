"""Where on the sensor, and when, a simulation has too many or too few events."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..distances.counts import Counts
from .style import ON_OFF, colours, styled

LIMIT = 0.5


@styled
def residual_maps(real: Counts, simulated: Mapping[str, Counts], watched: NDArray[np.bool_]) -> Figure:
    """real, simulated: count images (bins, rows, columns); watched: which cells count. Maps of
    log10(simulated / real) over all bins, and beneath them the same over time."""
    figure = Figure((2.6 * len(simulated) + 0.4, 4.4), layout="constrained")
    axes = figure.subplots(2, len(simulated), squeeze=False, height_ratios=[1.7, 1], sharey="row")
    colour = colours(list(simulated))
    seconds = np.arange(len(real)) * 0.05
    own = np.where(watched, real, 0)
    shown: Any = None
    for column, (name, counts) in enumerate(simulated.items()):
        other = np.where(watched, counts, 0)
        ratio = np.log10((other.sum(0) + 1) / (own.sum(0) + 1))
        image = np.where(watched.any(axis=0), ratio, np.nan)
        panel, line = axes[0, column], axes[1, column]
        panel.set_facecolor("#e3e6ea")  # what is not watched
        shown = panel.imshow(image, cmap=ON_OFF, vmin=-LIMIT, vmax=LIMIT, interpolation="nearest")
        panel.set_title(name)
        panel.set_xticks([])
        panel.set_yticks([])
        with np.errstate(divide="ignore", invalid="ignore"):
            over_time = np.log10(other.sum((1, 2)) / own.sum((1, 2)))
        line.axhline(0, color="#9aa2ac", linewidth=0.8)
        line.plot(seconds, np.where(np.isfinite(over_time), over_time, np.nan), ".-", color=colour[name])
        line.set_ylim(-LIMIT, LIMIT)
        line.set_xlabel("time [s]")
        line.grid(True)
    bar = figure.colorbar(shown, ax=axes[0, :], fraction=0.03, pad=0.01)
    bar.set_ticks([-0.477, 0, 0.477], labels=["1/3", "1", "3"])
    bar.set_label("simulated / real")
    axes[1, 0].set_yticks([-0.477, 0, 0.477], ["1/3", "1", "3"])
    axes[1, 0].set_ylabel("simulated / real")
    return figure
