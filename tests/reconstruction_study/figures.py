"""The study's figures."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from voltcam_lab.pages.style import REAL, colours, styled

from .contenders import ESIM, OURS, V2E
from .real import Real
from .results import Run, folder_of, values

PUBLISHED = {OURS: (0.030, 0.458), ESIM: (0.048, 0.406), V2E: (0.108, 0.336)}
"""MSE and SSIM of DVS-Voltmeter's Table 2; its own model stands where ours does."""


@styled
def scores(found: list[Run], recordings: list[Real]) -> Figure:
    """A dot for each seed, by model and recording."""
    names = list(dict.fromkeys(run.model for run in found))
    colour = colours(names)
    figure = Figure(figsize=(7.6, 0.9 + len(recordings) * (0.6 + 0.24 * len(names))), layout="constrained")
    axes = figure.subplots(len(recordings), 2, squeeze=False, sharey=True)
    for row, recording in zip(axes, recordings, strict=True):
        for axis, (measure, title) in zip(
            row,
            (("mse", "MSE, less is better"), ("ssim", "SSIM, more is better")),
            strict=True,
        ):
            for place, name in enumerate(names):
                seeds = values(found, name, recording.name, measure)
                axis.plot(seeds, np.full(len(seeds), place), "o", ms=4.5, color=colour[name], alpha=0.8)
                axis.plot([seeds.mean()] * 2, [place - 0.3, place + 0.3], color=colour[name])
                if recording.name == "slider_depth" and name in PUBLISHED:
                    published = PUBLISHED[name][measure == "ssim"]
                    axis.plot(published, place, "D", ms=5, mfc="none", color=REAL)
            axis.set_yticks(range(len(names)), names)
            axis.set_ylim(len(names) - 0.4, -0.6)
            axis.set_title(f"{recording.name}: {title}", fontsize=8.5)
            axis.locator_params(axis="x", nbins=5)
            axis.grid(axis="x")
    figure.supxlabel(
        "dots: networks; lines: means; diamonds: the paper's own figures, of its networks and recordings",
        fontsize=8,
    )
    return figure


@styled
def images(work: Path, found: list[Run], recordings: list[Real]) -> Figure:
    """The last frame of each recording, and what the networks of the first seed make of its events."""
    names = [name for name in dict.fromkeys(run.model for run in found) if ", without" not in name]
    figure = Figure(figsize=(7.6, 0.3 + 1.15 * len(recordings)), layout="constrained")
    axes = figure.subplots(len(recordings), 1 + len(names), squeeze=False)
    for row, recording in zip(axes, recordings, strict=True):
        frame = recording.frames[-1]
        low, high = np.percentile(frame, [0.5, 99.5])
        shown = [("real frame", frame)]
        for name in names:
            kept = folder_of(work, name) / f"{recording.name}.npy"
            if kept.exists():
                shown.append((name, np.load(kept)))
        for axis in row:
            axis.set_axis_off()
        for axis, (title, image) in zip(row, shown, strict=False):
            axis.imshow(image, cmap="gray", vmin=low, vmax=high)
            axis.set_title(f"{title.replace(', ', chr(10))}", fontsize=7)
    return figure


@styled
def losses(found: list[Run]) -> Figure:
    """Of training, the mean over seeds, smoothed over 20 steps."""
    names = [name for name in dict.fromkeys(run.model for run in found) if ", without" not in name]
    colour = colours(names)
    figure = Figure(figsize=(7.6, 2.6), layout="constrained")
    axis = figure.subplots()
    for name in names:
        every = [run.losses for run in found if run.model == name]
        mean = np.mean([each[: min(map(len, every))] for each in every], axis=0)
        width = min(20, len(mean))
        axis.plot(
            np.arange(width, len(mean) + 1), np.convolve(mean, np.ones(width) / width, "valid"),
            color=colour[name], label=name,
        )  # fmt: skip
    axis.set_xlabel("training step")
    axis.set_ylabel("loss: absolute error\n+ 0.3 (1 - SSIM)")
    axis.set_title("Training, mean over seeds, smoothed over 20 steps")
    axis.grid()
    axis.legend(ncols=3)
    return figure
