"""Parameters with their intervals, beside what is usual: dots and whiskers."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from ..pages.style import BLUE, REAL, styled
from .estimates import Estimate

USUAL, UNSURE = "#d9dee4", "#7a828c"
COLUMNS = 3


@styled
def parameter_intervals(estimates: Sequence[Estimate]) -> Figure:
    """One panel each, logarithmic: the value with its 90 % interval, blue where the recording fixes it, grey
    where it does not; the band is the prior's 90 %. What is 0 is an arrow at the left edge."""
    rows = -(-len(estimates) // COLUMNS)
    figure = Figure((9.0, 0.95 * rows + 0.3), layout="constrained")
    axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for panel, one in zip(axes, estimates, strict=False):
        colour = BLUE if one.determined else UNSURE
        panel.axvspan(*one.usual, color=USUAL, linewidth=0)
        edge = min(end for end in (one.usual[0], one.low, one.value) if end > 0) / 1.5
        low, value = max(one.low, edge), max(one.value, edge)
        panel.plot([low, one.high], [0, 0], color=colour, linewidth=2.5, solid_capstyle="round")
        panel.plot(value, 0, "o" if one.value > 0 else "<", color=colour, markersize=7, clip_on=False)
        panel.set_xscale("log")
        panel.set_xlim(edge, max(one.usual[1], one.high) * 1.5)
        panel.set_ylim(-1, 1)
        panel.set_yticks([])
        panel.spines["left"].set_visible(False)
        panel.minorticks_off()
        panel.set_title(f"{one.effect}.{one.parameter}", fontsize=8.5)
        panel.text(
            0.995, 0.93, f"{one.value:.3g}", transform=panel.transAxes, ha="right", va="top", color=REAL
        )
    for panel in axes[len(estimates) :]:
        panel.set_visible(False)
    return figure
