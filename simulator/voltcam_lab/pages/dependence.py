"""The functions that `told_apart` found: where real events are too many or too few for the model."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..dependence.covariates import LINES, ORDERS, PASTS, PHASES, TIMES, past_edges_us
from ..dependence.told_apart import Telling
from .style import OFF, ON, REAL, styled

FEWEST_SHARE = 2e-4  # of the real events: a bin with fewer says nothing
COLUMNS = 2
_ENDS = {"frame": PHASES, "time": TIMES, "y": LINES, "x": LINES, "clock": PHASES}
_TIMES = ((1e0, "1 us"), (1e2, "100 us"), (1e4, "10 ms"), (1e6, "1 s"))


@styled
def functions(steps: Sequence[Telling]) -> Figure:
    """A panel for each step; up: real events are more than the model's."""
    rows = max(1, -(-len(steps) // COLUMNS))
    figure = Figure((8.8, 2.5 * rows), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes, step in zip(panels, steps, strict=False):
        _function(axes, step)
    for axes in panels[len(steps) :]:
        axes.remove()
    if len(steps):
        panels[0].legend(loc="best")
    return figure


def _function(axes: Axes, step: Telling) -> None:
    name = step.covariate.name
    axes.axhline(0, color=REAL, linewidth=0.8)
    for polarity, (word, colour) in enumerate((("OFF", OFF), ("ON", ON))):
        shown = np.where(step.share[polarity] >= FEWEST_SHARE, step.function[polarity], np.nan)
        axes.stairs(shown, np.arange(shown.size + 1), color=colour, baseline=None, label=word)
    axes.set_title(f"{1000 * step.gain:.1f} millinats an event")
    axes.set_xlabel(step.covariate.title)
    axes.set_ylabel("ln (real : simulated)")
    if name in PASTS:
        edges = past_edges_us()
        places = [
            float(np.interp(np.log(at), np.log(edges), np.arange(1, edges.size + 1))) for at, _ in _TIMES
        ]
        axes.set_xticks(places, [word for _, word in _TIMES])
    elif name == "order":
        axes.set_xticks(
            np.arange(1, len(ORDERS), 3) + 0.5, [f"{ORDERS[k]:+d} px" for k in range(1, len(ORDERS), 3)]
        )
    elif name in _ENDS:
        axes.set_xticks(np.linspace(0, _ENDS[name], 5), ["0", "25 %", "50 %", "75 %", "100 %"])
