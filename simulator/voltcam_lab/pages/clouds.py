"""Events of several models beside real ones: the paper's Fig. 5."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..distances.inter_event_intervals import Intervals, wasserstein
from .style import OFF, ON, ON_OFF, REAL, colours, styled

DECAY_US = 3000.0
WINDOW_US, SIDE = 80_000, 64
MOST_POINTS = 2500


@dataclass(frozen=True)
class Window:
    """What a cloud shows: from begin_us for span_us, the side x side pixels from (x, y) on."""

    begin_us: int
    x: int
    y: int
    span_us: int = WINDOW_US
    side: int = SIDE

    def of(self, events: Events) -> Events:
        """The events in it."""
        first, last = np.searchsorted(events["t"], [self.begin_us, self.begin_us + self.span_us])
        part = events[first:last]
        x, y = part["x"].astype(np.int64) - self.x, part["y"].astype(np.int64) - self.y
        inside: Events = part[(x >= 0) & (x < self.side) & (y >= 0) & (y < self.side)]
        return inside

    def fullest_us(self, events: Events) -> int:
        """The instant in it just before which most of its events come; its end without any."""
        t_us = self.of(events)["t"]
        if not t_us.size:
            return self.begin_us + self.span_us
        recent = np.arange(t_us.size) - np.searchsorted(t_us, t_us - int(DECAY_US))
        return int(t_us[np.argmax(recent)]) + 1


def busiest(events: Events, width: int, height: int) -> Window:
    """The window in which most happens."""
    if not events.size:
        return Window(0, 0, 0)
    begin_us = int(events["t"][0])
    at = int(np.argmax(np.bincount((events["t"] - begin_us) // WINDOW_US)))
    begin_us += at * WINDOW_US
    first, last = np.searchsorted(events["t"], [begin_us, begin_us + WINDOW_US])
    part, step = events[first:last], SIDE // 4
    counts = np.zeros((-(-height // step), -(-width // step)))
    np.add.at(counts, (part["y"] // step, part["x"] // step), 1)
    gathered = np.array([
        [counts[row : row + 4, column : column + 4].sum() for column in range(max(1, counts.shape[1] - 3))]
        for row in range(max(1, counts.shape[0] - 3))
    ])  # fmt: skip
    row, column = np.unravel_index(int(np.argmax(gathered)), gathered.shape)
    return Window(begin_us, int(column) * step, int(row) * step)


@styled
def clouds(streams: Mapping[str, Events], intervals: Mapping[str, Intervals], window: Window) -> Figure:
    """streams, intervals: by name, the real one first. A column each: the cloud; the window's time surface
    with 3.0 ms decay, when it has most real events; the density of same-pixel same-polarity intervals, the
    real one's in grey."""
    figure = Figure((2.15 * len(streams), 6.3), layout="constrained")
    rows: Any = figure.subfigures(3, 1, height_ratios=[1.15, 0.9, 0.9])
    real, *_ = intervals.values()
    surface_us = window.fullest_us(next(iter(streams.values())))
    colour = colours(list(streams))
    surface: Any = None
    cloud_axes = rows[0].subplots(1, len(streams), squeeze=False, subplot_kw={"projection": "3d"})[0]
    surfaces = rows[1].subplots(1, len(streams), squeeze=False)[0]
    densities = rows[2].subplots(1, len(streams), squeeze=False, sharey=True)[0]
    for column, (name, events) in enumerate(streams.items()):
        part = window.of(events)
        cloud_axes[column].set_title(f"{name}\n{_in_words(part.size)}", fontsize=9, loc="center")
        _cloud(cloud_axes[column], part, window)
        image = time_surface(events, surface_us, window)
        surface = surfaces[column].imshow(image, cmap=ON_OFF, vmin=-1, vmax=1, interpolation="nearest")
        surfaces[column].set_xticks([])
        surfaces[column].set_yticks([])
        own = intervals[name]
        _density(densities[column], real, own, REAL if own is real else colour[name])
    bar = rows[1].colorbar(surface, ax=surfaces, fraction=0.012, pad=0.01, ticks=[-1, 0, 1])
    bar.ax.set_yticklabels(["OFF", "", "ON"])
    densities[0].set_ylabel("density per decade")
    return figure


def time_surface(events: Events, t_us: int, window: Window) -> NDArray[np.float64]:
    """(side, side) of the window: exp(-age / 3.0 ms) of each pixel's last event before t_us, negative for
    OFF, 0 without one."""
    span_us = int(10 * DECAY_US)
    part = replace(window, begin_us=t_us - span_us, span_us=span_us).of(events)
    image = np.zeros((window.side, window.side))
    sign = np.where(part["p"], 1.0, -1.0)
    image[part["y"] - window.y, part["x"] - window.x] = sign * np.exp((part["t"] - t_us) / DECAY_US)
    return image  # of several events the last one stays


def _cloud(axes: Any, events: Events, window: Window) -> None:
    shown = events[:: max(1, -(-events.size // MOST_POINTS))]
    t_ms = (shown["t"] - window.begin_us) / 1000.0
    axes.scatter(
        t_ms, shown["x"], shown["y"], c=np.where(shown["p"], ON, OFF), s=2, alpha=0.6, linewidths=0,
        depthshade=False, rasterized=True,
    )  # fmt: skip
    axes.set_xlim(0, window.span_us / 1000)
    axes.set_ylim(window.x, window.x + window.side)
    axes.set_zlim(window.y + window.side, window.y)
    axes.set_box_aspect((1.5, 1, 1), zoom=1.2)
    axes.view_init(elev=18, azim=-62)
    axes.set_xticks([0, window.span_us // 2000, window.span_us // 1000])
    axes.set_yticks([])
    axes.set_zticks([])
    axes.set_xlabel("t [ms]", labelpad=-8, fontsize=8)
    axes.set_ylabel("x", labelpad=-14, fontsize=8)
    axes.set_zlabel("y", labelpad=-14, fontsize=8)
    axes.tick_params(pad=-3, labelsize=7)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color("#f6f7f9")
        axis.line.set_color("#c3c9d0")


def _density(axes: Any, real: Intervals, own: Intervals, colour: str) -> None:
    edges = np.arange(2, 6.51, 0.1)
    grey = np.histogram(real.decades, edges)[0] / max(real.decades.size, 1) * 10
    axes.stairs(grey, edges, fill=True, color="#cfd4da")
    if own is not real:
        line = np.histogram(own.decades, edges)[0] / max(own.decades.size, 1) * 10
        axes.stairs(line, edges, color=colour, linewidth=1.5)
        axes.set_title(f"W1 {wasserstein(real, own):.3f}", fontsize=8, loc="right", pad=2, weight="normal")
    axes.set_xticks([3, 4, 5, 6], ["1 ms", "", "100 ms", ""])
    axes.set_xlim(2.5, 6.5)
    axes.set_yticks([])


def _in_words(count: int) -> str:
    return f"{count / 1000:.1f} k events" if count >= 1000 else f"{count} events"
