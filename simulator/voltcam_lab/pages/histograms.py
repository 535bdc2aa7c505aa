"""Interval histograms by brightness and change, measured against simulated: the paper's Fig. 4."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ..distances.inter_event_intervals import Intervals, IntervalStrata
from .style import REAL, colours, styled

EDGES = np.arange(2, 6.51, 0.1)


@styled
def interval_histograms(
    real: Intervals, simulated: Mapping[str, Intervals], strata: IntervalStrata
) -> Figure:
    """Rows: terciles of brightness; columns: of |d ln L / dt|. Real in grey, models as lines. A row of panels
    ends at twice its highest real share: a model that has all in one place does not flatten the others."""
    figure = Figure((8.8, 5.6), layout="constrained")
    axes = figure.subplots(3, 3, sharex=True, sharey="row")
    colour = colours(list(simulated))
    dark, bright = strata.brightness_dn
    slow, fast = strata.speed_per_s
    rows = (f"below {dark:.0f} DN", f"{dark:.0f} to {bright:.0f} DN", f"above {bright:.0f} DN")
    columns = (f"|d ln L/dt| < {slow:.2g} /s", f"{slow:.2g} to {fast:.2g} /s", f"> {fast:.2g} /s")
    highest = np.zeros(3)  # real share of each row
    for name, intervals in {"real": real, **simulated}.items():
        brightness, speed = strata.numbers(intervals)
        for row in range(3):
            for column in range(3):
                decades = intervals.decades[(brightness == row) & (speed == column)]
                shares = np.histogram(decades, EDGES)[0] / max(decades.size, 1) * 10
                if name == "real":
                    highest[row] = max(highest[row], shares.max())
                    axes[row, column].stairs(shares, EDGES, fill=True, color="#cfd4da", label=name)
                else:
                    axes[row, column].stairs(shares, EDGES, color=colour[name], linewidth=1.3, label=name)
    for column in range(3):
        axes[0, column].set_title(columns[column], loc="center", fontsize=9)
        axes[2, column].set_xticks([3, 4, 5, 6], ["1 ms", "10 ms", "100 ms", "1 s"])
        axes[2, column].set_xlim(2, 6.5)
        for row in range(3):
            axes[row, column].set_yticks([])
    for row in range(3):
        axes[row, 0].set_ylabel(rows[row], color=REAL)
        if highest[row] > 0:
            axes[row, 0].set_ylim(0, 2 * highest[row])
    figure.supxlabel("time between two events of a pixel and polarity", fontsize=9)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure
