"""Events at random, and what a figure shows of them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import StepPatch

from voltcam_lab.distances import FrameLight, Region
from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events

WIDTH, HEIGHT = 96, 80


def some_events(seed: int, size: int = 20_000) -> Events:
    rng = np.random.default_rng(seed)
    events = np.empty(size, EVENT)
    events["t"] = np.sort(rng.integers(0, 1_000_000, size))
    events["x"], events["y"] = rng.integers(0, WIDTH, size), rng.integers(0, HEIGHT, size)
    events["p"] = rng.random(size) < 0.5
    return events


def with_data(figure: Figure) -> int:
    """How many clouds, images, histograms, curves and rows of points with data a figure has."""
    return sum(map(_with_data, figure.get_axes()))


def _with_data(axes: Axes) -> int:
    """Lines of two points are floors and frames."""
    lines = [line for line in axes.lines if line.get_marker() != "None" or len(line.get_xydata()) > 2]
    clouds = [cloud for cloud in axes.collections if hasattr(cloud, "_offsets3d")]
    points = [line.get_xydata() for line in lines] + [np.stack(one._offsets3d, axis=1) for one in clouds]
    images = [np.asarray(image.get_array()) for image in axes.images]
    steps = [patch.get_data().values for patch in axes.patches if isinstance(patch, StepPatch)]
    finite = sum(np.isfinite(xy).all(axis=1).any() for xy in points)
    return int(finite + sum(np.ptp(values) > 0 for values in [*images, *steps]))


REGION = Region.whole(WIDTH, HEIGHT, 0, 1_000_000)


def light() -> FrameLight:
    """11 frames of noise."""
    frames = np.random.default_rng(0).integers(0, 255, (11, HEIGHT, WIDTH)).astype(np.uint8)
    return FrameLight(frames, np.arange(11, dtype=np.int64) * 100_000)
