"""Figures of a diagnosis from its statistics: measured, before and after."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...pages.style import BLUE, ON_OFF, ORANGE, REAL, styled
from ...statistics import LABELS, Setting
from ...statistics.inter_event_times import COARSE_MS, FINE_MS, POLARITY_PAIRS
from ...statistics.strata import INTENSITY_NAMES, SLOPE_NAMES
from .where import Ranked

Series = Mapping[str, NDArray[np.float64]]
"""Name -> (n,) the statistics, counts as numbers, summed over the parts; "measured" first."""

SERIES_COLOURS = {"measured": REAL, "before": ORANGE, "after": BLUE, "model": BLUE}
FILL, EDGE = "#d5dae1", "#9aa2ac"
_HEAT = LinearSegmentedColormap.from_list("heat", ["#f4f6f9", "#9fc4e0", "#2a78b4", "#0b2f57"])
_GROUPS = {
    "A": "rates", "B": "intervals", "C": "pixels", "D": "readout", "E": "spectrum", "F": "frame phase",
    "G": "trend", "H": "lag", "I": "neighbours", "J": "first passage",
    "K": "net events", "L": "silence",
}  # fmt: skip


def cells(group: str, name: str, *axes: str) -> NDArray[np.int64]:
    """Numbers of the statistics of this name and these axes, in a table with these axes."""
    chosen = [
        (i, label)
        for i, label in enumerate(LABELS)
        if (label.group, label.name) == (group, name) and tuple(key for key, _ in label.strata) == axes
    ]
    shape = [len({label.strata[k][1] for _, label in chosen}) for k in range(len(axes))]
    return np.array([i for i, _ in chosen]).reshape(shape)


@styled
def gap_bars(found: Mapping[str, tuple[float, float]]) -> Figure:
    """The gap of each model, by name, in held-out data, and its floor, what chance alone leaves."""
    figure = Figure((8.8, 0.95 + 0.42 * len(found)), layout="constrained")
    axes: Any = figure.subplots()
    names, held_out = list(found), [gap for gap, _ in found.values()]
    colours = [ORANGE] + [BLUE] * (len(found) - 1) if len(found) > 1 else [BLUE]
    y = np.arange(len(names))
    axes.barh(y, held_out, height=0.5, color=colours)
    for row, (gap, floor) in enumerate(found.values()):
        axes.plot([floor] * 2, [row - 0.36, row + 0.36], color=REAL, linewidth=2)
        axes.annotate(
            f"{gap:.2f}", (gap, row), xytext=(5, 0), textcoords="offset points",
            va="center", fontsize=9, weight="bold",
        )  # fmt: skip
    axes.set_yticks(y, names)
    axes.tick_params(axis="y", labelsize=9, length=0)
    axes.invert_yaxis()
    axes.set_xlim(0, 1.12 * max(held_out))
    axes.set_xlabel("gap on held-out data; the dark mark is what chance alone would leave")
    return figure


@styled
def deviation_dots(found: Mapping[str, Ranked]) -> Figure:
    """Every statistic, by group: how far the data are from each model, in twins' spreads."""
    figure = Figure((8.8, 0.7 + 1.75 * len(found)), layout="constrained")
    rows = figure.subplots(len(found), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    letters = np.array([label.group for label in LABELS])
    place = np.arange(len(LABELS)) + 14 * np.cumsum(np.append(False, letters[1:] != letters[:-1]))
    for axes, (name, one) in zip(rows, found.items(), strict=True):
        axes.axhspan(-3, 3, color="#e8ebef", linewidth=0)
        axes.axhline(0, color=EDGE, linewidth=0.6)
        axes.vlines(place, 0, one.z, color=SERIES_COLOURS[name], linewidth=0.6, alpha=0.45, rasterized=True)
        axes.scatter(place, one.z, s=5, color=SERIES_COLOURS[name], linewidths=0, rasterized=True)
        axes.set_yscale("symlog", linthresh=5, linscale=1.2)
        axes.set_ylabel(f"z {name}")
    most = max(12.0, *(float(np.abs(one.z).max()) for one in found.values()))
    rows[0].set_ylim(-1.4 * most, 1.4 * most)
    ticks = [t for t in (-1000, -100, -20, -5, 0, 5, 20, 100, 1000) if abs(t) < most]
    rows[0].set_yticks(ticks, [str(t).replace("-", "−") for t in ticks])
    rows[0].minorticks_off()
    middle = [float(place[letters == letter].mean()) for letter in _GROUPS]
    rows[-1].set_xticks(middle, list(_GROUPS.values()))
    rows[-1].tick_params(axis="x", length=0)
    rows[0].set_xlim(place[0] - 8, place[-1] + 8)
    return figure


@styled
def group_gap_bars(found: Mapping[str, Mapping[str, tuple[float, float]]]) -> Figure:
    """The held-out gap of each group of statistics, by model, and its floor."""
    figure = Figure((8.8, 2.3), layout="constrained")
    axes: Any = figure.subplots()
    width = 0.7 / len(found)
    for k, (name, groups) in enumerate(found.items()):
        x = np.arange(len(groups)) + (k - (len(found) - 1) / 2) * width
        axes.bar(x, [gap for gap, _ in groups.values()], 0.88 * width, color=SERIES_COLOURS[name], label=name)
        floors = [floor for _, floor in groups.values()]
        half = 0.5 * width
        axes.hlines(floors, x - half, x + half, color=REAL, linewidth=2, label="floor" if not k else None)
    axes.set_xticks(range(len(_GROUPS)), list(_GROUPS.values()))
    axes.tick_params(axis="x", length=0)
    axes.set_ylabel("gap, held out")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(bottom=0.05)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper right", ncols=len(found) + 1)
    return figure


@styled
def rate_maps(series: Series, setting: Setting) -> Figure:
    """Events per pixel and second by brightness and its change; models as a share of the measured."""
    index = cells("A", "events", "polarity", "intensity", "slope")[::-1]  # ON first
    seconds = setting.seconds.sum(axis=0)
    figure = Figure((8.8, 4.6), layout="constrained")
    axes = figure.subplots(2, len(series), sharex=True, sharey=True)
    measured = series["measured"][index] / np.maximum(seconds, 1e-9)
    top = max(float(measured.max()), 1.0)
    heat: Any = None
    ratio: Any = None
    for column, (name, values) in enumerate(series.items()):
        for row, polarity in enumerate(("ON", "OFF")):
            panel, rate = axes[row, column], values[index[row]] / np.maximum(seconds, 1e-9)
            if name == "measured":
                norm = LogNorm(top / 3000, top)
                heat = panel.imshow(np.maximum(rate, top / 3000), cmap=_HEAT, norm=norm, aspect="auto")
                texts, light = [[f"{x:.2g}" for x in line] for line in rate], rate > top / 30
            else:
                few = series["measured"][index[row]] + values[index[row]] < 8
                share = (values[index[row]] + 0.5) / (series["measured"][index[row]] + 0.5)
                logs = np.where(few, np.nan, np.log2(share))
                ratio = panel.imshow(logs, cmap=ON_OFF.reversed(), vmin=-1, vmax=1, aspect="auto")
                texts = [
                    ["" if none else f"{x:.2g}" for x, none in zip(*line, strict=True)]
                    for line in zip(share, few, strict=True)
                ]
                light = np.abs(logs) > 0.8
            panel.set_facecolor("#eceff3")
            _write(panel, texts, light)
            panel.set_title(f"{polarity} {name}")
            panel.set_yticks(range(len(INTENSITY_NAMES)), INTENSITY_NAMES)
            panel.set_xticks(range(len(SLOPE_NAMES)), SLOPE_NAMES, rotation=35, ha="right")
            panel.tick_params(length=0)
            panel.spines[:].set_visible(False)
    figure.colorbar(heat, ax=axes[:, 0], fraction=0.05, pad=0.02, location="left").set_label("events/s/pixel")
    bar = figure.colorbar(ratio, ax=axes[:, -1], fraction=0.05, pad=0.02)
    bar.set_ticks([-1, 0, 1], labels=["half", "equal", "twice"])
    return figure


def _write(panel: Any, texts: list[list[str]], light: NDArray[np.bool_]) -> None:
    for y, line in enumerate(texts):
        for x, text in enumerate(line):
            panel.text(x, y, text, ha="center", va="center", fontsize=6.5, color="w" if light[y, x] else REAL)


@styled
def inter_event_histograms(series: Series) -> Figure:
    """Times between two events of a pixel: moving, of one polarity, and at rest, by pair of them."""
    fine = cells("B", "intervals, moving", "polarity", "interval")
    coarse = cells("B", "intervals", "pair", "interval")
    figure = Figure((8.8, 4.6), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=[1.25, 1])
    top, bottom = parts
    for panel, row, title in zip(
        top.subplots(1, 2), (1, 0), ("ON to ON, moving", "OFF to OFF, moving"), strict=True
    ):
        _steps(panel, series, fine[row], _edges(FINE_MS), title)
        panel.set_ylabel("events")
    for panel, row in zip(bottom.subplots(1, 4), range(4), strict=True):
        title = POLARITY_PAIRS[row].replace(" at", ", at").replace(" O", " to O")
        _steps(panel, series, coarse[row], _edges(COARSE_MS), title)
    figure.legend(*_handles(top), loc="outside upper right", ncols=len(series))
    return figure


def _edges(inner_ms: tuple[float, ...]) -> NDArray[np.float64]:
    return np.array([inner_ms[0] / 3, *inner_ms, inner_ms[-1] * 3])


def _steps(panel: Any, series: Series, index: NDArray[np.int64], edges: Any, title: str) -> None:
    for name, values in series.items():
        measured = name == "measured"
        panel.stairs(
            values[index], edges, fill=measured, color=FILL if measured else SERIES_COLOURS[name], label=name,
            linewidth=0 if measured else 1.7,
        )  # fmt: skip
    panel.set_title(title)
    panel.set_xscale("log")
    ticks = [t for t in (0.1, 1, 10, 100, 1000) if edges[0] <= t <= edges[-1]]
    panel.set_xticks(ticks, [f"{t:g} ms" if t < 1000 else "1 s" for t in ticks])
    panel.minorticks_off()
    panel.set_ylim(0, max(1.0, panel.get_ylim()[1]))  # nothing at all is drawn as nothing


def _handles(figure: Any) -> Any:
    return figure.axes[0].get_legend_handles_labels()


@styled
def lag_response_curves(series: Series) -> Figure:
    """Change of ln L in each span of time before the events (ON +, OFF -), by brightness, per event."""
    index = cells("H", "change before events", "intensity", "lag")
    rates = cells("A", "events", "polarity", "intensity", "slope")
    names = [dict(LABELS[i].strata)["lag"].removesuffix(" ms") for i in index[0]]
    figure = Figure((8.8, 2.7), layout="constrained")
    panels = figure.subplots(1, len(INTENSITY_NAMES), sharey=True)
    for k, panel in enumerate(panels):
        for name, values in series.items():
            events = max(float(values[rates[:, k]].sum()), 1.0)
            shown = values[index[k]] / events
            if name == "measured":
                panel.bar(range(len(shown)), shown, width=1, color=FILL, label=name)
            else:
                panel.plot(shown, "o-", markersize=3.5, color=SERIES_COLOURS[name], label=name)
        panel.axhline(0, color=EDGE, linewidth=0.6)
        panel.set_title(INTENSITY_NAMES[k])
        panel.set_xticks(range(len(names)), names, rotation=60, ha="right", fontsize=7)
    panels[0].set_ylabel("change of ln L per event")
    figure.supxlabel("ms before the event", fontsize=9)
    handles, labels = panels[0].get_legend_handles_labels()
    order = [labels.index(name) for name in series]
    figure.legend([handles[k] for k in order], list(series), loc="outside upper right", ncols=len(series))
    return figure
