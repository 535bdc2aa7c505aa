"""Streams that are made up, and the light that they are in."""

import numpy as np

from voltcam_lab.distances import (
    FrameLight,
    Region,
)
from voltcam_simulator import EVENT
from voltcam_simulator.effect import Events

WIDTH, HEIGHT, END_US = 72, 60, 1_600_000


WHOLE = Region.whole(WIDTH, HEIGHT, 0, END_US)


def stream(t: np.ndarray, x: np.ndarray, y: np.ndarray, p: np.ndarray) -> Events:
    events = np.empty(len(t), EVENT)
    events["t"], events["x"], events["y"], events["p"] = t, x, y, p
    return events[np.argsort(events["t"], kind="stable")]


def poisson(seed: int, rate_hz: float = 40.0, end_us: int = END_US, width: int = WIDTH) -> Events:
    """Every pixel at the same rate, polarities by toss."""
    rng = np.random.default_rng(seed)
    n = rng.poisson(rate_hz * end_us / 1e6 * width * HEIGHT)
    return stream(
        rng.integers(0, end_us, n), rng.integers(0, width, n), rng.integers(0, HEIGHT, n), rng.random(n) < 0.5
    )


def renewal(rng: np.random.Generator, mean_us: float, per_pixel: int = 100) -> Events:
    """Exponential intervals, ON only, per_pixel + 1 events at each pixel, however long that takes."""
    spans = np.ceil(rng.exponential(mean_us, (HEIGHT, WIDTH, per_pixel))).astype(np.int64)
    t = np.concatenate([np.zeros((HEIGHT, WIDTH, 1), np.int64), np.cumsum(spans, axis=2)], axis=2)
    y, x, _ = np.indices(t.shape)
    return stream(t.ravel(), x.ravel(), y.ravel(), np.ones(t.size, bool))


def still_light(frames: int = 51, width: int = WIDTH) -> FrameLight:
    """Left half 50 DN, right half 150 DN, for END_US."""
    image = np.full((HEIGHT, width), 50, np.uint8)
    image[:, width // 2 :] = 150
    return FrameLight(np.repeat(image[None], frames, axis=0), np.linspace(0, END_US, frames).astype(np.int64))
