"""Distances of all models in one view, beside the recording's own floor."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ...distances import HEADLINES, MEASURES
from ...pages.style import REAL, colours, styled

LEAST = 1e-4


@styled
def dots(table: Mapping[str, Mapping[str, float]], floors: Mapping[str, Mapping[str, float]]) -> Figure:
    """table: model -> measure -> value; floors: real against real, by kind. Each measure's axis is the
    distance from what is best, in decades: left is closer to real; inside the band, as close as real is."""
    names = list(table)
    figure = Figure((2.0 * len(HEADLINES) + 1.2, 0.32 * len(names) + 1.3), layout="constrained")
    axes = figure.subplots(1, len(HEADLINES), sharey=True)
    colour = colours(names)
    for panel, measure in zip(axes, HEADLINES, strict=True):
        best = MEASURES[measure].best or 0.0
        ends = [max(abs(floor[measure] - best), LEAST) for floor in floors.values() if measure in floor]
        floor = max([end for end in ends if end == end], default=np.nan)
        if floor == floor:
            panel.axvspan(LEAST / 10, floor, color="#e3e6ea", linewidth=0)
            panel.axvline(floor, color=REAL, linewidth=1, linestyle=(0, (3, 2)))
        for row, name in enumerate(names):
            value = table[name][measure]
            if value == value:
                panel.plot(max(abs(value - best), LEAST), row, "o", color=colour[name], markersize=7)
        panel.set_xscale("log")
        panel.set_title({"b4": "1 - b4", "AUC": "AUC - ½"}.get(measure, measure))
        values = [abs(row[measure] - best) for row in table.values() if row[measure] == row[measure]]
        known = [value for value in [*values, floor] if value == value]
        panel.set_xlim(0.5 * max(min(known, default=0.01), LEAST), 2 * max(max(known, default=1), LEAST))
        panel.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
        panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.grid(True, axis="x")
        panel.grid(True, axis="y", linestyle=":")
    axes[0].set_yticks(range(len(names)), names)
    axes[0].set_ylim(len(names) - 0.5, -0.5)
    figure.supxlabel("distance from real events (grey: real against real)", fontsize=9)
    return figure
