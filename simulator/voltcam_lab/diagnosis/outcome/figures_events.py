"""Figures of a diagnosis from the events themselves: measured, before and after."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.fft
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ...pages.style import ON_OFF, REAL, styled
from ...statistics import Setting
from .figures_statistics import FILL, SERIES_COLOURS

Streams = Mapping[str, list[Events]]
"""Name -> runs of events, where light is trusted; "measured" first, with one."""

_HEAT = LinearSegmentedColormap.from_list("night", ["#f4f6f9", "#9fc4e0", "#2a78b4", "#0b2f57"])
_BIN_US, _SHOWN_HZ, _SMOOTH_HZ = 500, (10.0, 500.0), 1.0


@styled
def pixel_maps(streams: Streams, setting: Setting) -> Figure:
    """Events of each pixel per second, and how far a run of each model is from that, in spreads of chance."""
    shape, seconds = (setting.scene.height, setting.scene.width), _seconds(setting)
    counts = {name: _map(runs[0], shape) for name, runs in streams.items()}  # fixed patterns blur in means
    wide = shape[1] / shape[0]
    figure = Figure((8.8, min(6.4, 0.8 + 2 * 2.6 / max(wide, 0.4))), layout="constrained")
    axes = figure.subplots(2, len(streams), squeeze=False)
    top = max(float(np.quantile(counts["measured"], 0.999)), 1.0) / seconds
    low = max(top / 300, 0.5 / seconds)
    others = list(counts)[1:]
    most = float(np.clip(np.quantile([np.abs(_scores(counts, name)) for name in others], 0.995), 3, 8))
    heat: Any = None
    off: Any = None
    for column, (name, map_) in enumerate(counts.items()):
        rate = np.maximum(map_ / seconds, low)
        heat = axes[0, column].imshow(rate, cmap=_HEAT, norm=LogNorm(low, top), interpolation="nearest")
        axes[0, column].set_title(name)
        if column:
            z = _scores(counts, name)
            off = axes[1, column].imshow(
                z, cmap=ON_OFF.reversed(), vmin=-most, vmax=most, interpolation="nearest"
            )
            axes[1, column].set_title(f"{name} less measured")
    for panel in axes.flat:
        panel.set_xticks([])
        panel.set_yticks([])
        panel.spines[:].set_visible(False)
    axes[1, 0].hist(
        [np.clip(_scores(counts, name).ravel(), -most, most) for name in others],
        bins=np.linspace(-most, most, 41).tolist(), histtype="step",
        color=[SERIES_COLOURS[name] for name in others], linewidth=1.6,
    )  # fmt: skip
    axes[1, 0].set_title("how far pixels are off")
    axes[1, 0].set_xticks([-3, 0, 3])
    axes[1, 0].set_xlabel("spreads of chance")
    axes[1, 0].set_box_aspect(shape[0] / shape[1])
    figure.colorbar(heat, ax=axes[0, :], fraction=0.03, pad=0.01).set_label("events/s")
    figure.colorbar(off, ax=axes[1, :], fraction=0.03, pad=0.01).set_label("spreads")
    return figure


def _scores(counts: Mapping[str, NDArray[np.float64]], name: str) -> NDArray[np.float64]:
    z: NDArray[np.float64] = (counts[name] - counts["measured"]) / np.sqrt(
        counts[name] + counts["measured"] + 1
    )
    return z


def _map(events: Events, shape: tuple[int, int]) -> NDArray[np.float64]:
    index = events["y"].astype(np.int64) * shape[1] + events["x"]
    return np.bincount(index, minlength=shape[0] * shape[1]).reshape(shape).astype(np.float64)


@styled
def spectrum_curves(streams: Streams, setting: Setting) -> Figure:
    """Amplitude of ON less OFF by frequency, per root of events: near 1 where they come at random."""
    figure = Figure((8.8, 2.6), layout="constrained")
    panel: Any = figure.subplots()
    top = 3.0
    for name, runs in streams.items():
        hz, amplitude = _largest([_amplitudes(run, setting) for run in runs])
        measured = name == "measured"
        top = max(top, float(amplitude.max()))
        if measured:
            panel.fill_between(hz, amplitude, color=FILL, label=name, linewidth=0)
        else:
            panel.plot(hz, amplitude, color=SERIES_COLOURS[name], linewidth=1.0, label=name)
    for mains in (50, 60, 100, 120):
        panel.axvline(mains, color=REAL, linewidth=0.5, linestyle=":")
    panel.set_xscale("log")
    panel.set_xlim(*_SHOWN_HZ)
    panel.set_xticks([10, 20, 50, 100, 200, 500], ["10 Hz", "20", "50", "100", "200", "500 Hz"])
    panel.minorticks_off()
    panel.set_ylim(0, 1.05 * top)
    panel.set_ylabel("amplitude")
    panel.legend(loc="upper right", ncols=len(streams))
    return figure


def _amplitudes(events: Events, setting: Setting) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    begin_us, end_us = setting.scene.t_us[[0, -1]]
    bins = int((end_us - begin_us) // _BIN_US) + 1
    signed = np.bincount(
        (events["t"] - begin_us) // _BIN_US, np.where(events["p"], 1.0, -1.0), minlength=bins
    )
    size = scipy.fft.next_fast_len(2 * bins, real=True)
    amplitude = np.abs(np.asarray(scipy.fft.rfft(signed, size))) / np.sqrt(max(len(events), 1))
    return np.asarray(scipy.fft.rfftfreq(size, _BIN_US * 1e-6), np.float64), amplitude


def _largest(
    runs: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """In steps of _SMOOTH_HZ or 1 % the largest, so that a narrow line is not lost; mean over runs."""
    hz = runs[0][0]
    edges = np.unique(np.searchsorted(hz, _grid()))
    largest = np.mean([np.maximum.reduceat(amplitude, edges)[:-1] for _, amplitude in runs], axis=0)
    return hz[edges[:-1]], largest


def _grid() -> NDArray[np.float64]:
    grid = [_SHOWN_HZ[0]]
    while grid[-1] < _SHOWN_HZ[1]:
        grid.append(grid[-1] + max(_SMOOTH_HZ, 0.01 * grid[-1]))
    return np.array(grid)


@styled
def frame_phase_histograms(streams: Streams, setting: Setting) -> Figure:
    """When in the frame's period events come, and by row: what the readout does runs down the rows."""
    figure = Figure((8.8, 4.8), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=[1, 1.25])
    top, bottom = parts
    bins = int(np.clip(len(streams["measured"][0]) // 150, 16, 100))
    edges = np.linspace(0, setting.frame_period_us / 1000, bins + 1)
    for panel, on in zip(top.subplots(1, 2), (True, False), strict=True):
        for name, runs in streams.items():
            phases = [_phase(run[run["p"] == on], setting) for run in runs]
            counts = np.histogram(np.concatenate(phases), bins, (0, 1))[0]
            measured = name == "measured"
            share = counts * bins / max(counts.sum(), 1)
            if measured:
                panel.stairs(share, edges, fill=True, color=FILL, label=name)
            else:
                panel.stairs(
                    share, edges, baseline=None, color=SERIES_COLOURS[name], linewidth=1.4, label=name
                )
        panel.set_title("ON" if on else "OFF")
        panel.set_xlim(0, edges[-1])
        panel.set_ylim(bottom=0)
        panel.set_xlabel("ms after the frame began")
    top.axes[0].set_ylabel("events, of the mean")
    figure.legend(*top.axes[0].get_legend_handles_labels(), loc="outside upper right", ncols=len(streams))
    _row_scan(bottom, streams, setting)
    return figure


def _row_scan(figure: Any, streams: Streams, setting: Setting) -> None:
    panels = figure.subplots(1, len(streams), squeeze=False, sharey=True)[0]
    rows, events = setting.scene.height, len(streams["measured"][0])
    bands = min(rows, 26)
    bins = int(np.clip(events // (12 * bands), 8, 80))
    images = {}
    for name, runs in streams.items():
        run = np.concatenate(runs)
        band = run["y"].astype(np.int64) * bands // rows
        image, _, _ = np.histogram2d(band, _phase(run, setting), (bands, bins), ((0, bands), (0, 1)))
        images[name] = image / np.maximum(image.mean(axis=1, keepdims=True), 1e-9)
    top = max(2.0, float(np.quantile(images["measured"], 0.995)))
    shown: Any = None
    for panel, (name, image) in zip(panels, images.items(), strict=True):
        shown = panel.imshow(
            image, cmap=_HEAT, vmin=0, vmax=top, aspect="auto", interpolation="nearest",
            extent=(0, setting.frame_period_us / 1000, rows, 0),
        )  # fmt: skip
        panel.set_title(name)
        panel.set_xlabel("ms after the frame began")
    panels[0].set_ylabel("row")
    figure.colorbar(shown, ax=panels, fraction=0.03, pad=0.01).set_label("events, of the row's mean")


def _phase(events: Events, setting: Setting) -> NDArray[np.float64]:
    """(n,) in [0, 1)."""
    starts_us = setting.frame_starts_us
    frame = np.maximum(np.searchsorted(starts_us, events["t"], side="right") - 1, 0)
    phase: NDArray[np.float64] = ((events["t"] - starts_us[frame]) / setting.frame_period_us) % 1.0
    return phase


def _seconds(setting: Setting) -> float:
    return float(setting.scene.t_us[-1] - setting.scene.t_us[0]) * 1e-6
