"""Streams whose firing depends on something, and light that does not move."""

import numpy as np

from voltcam_lab.dependence.covariates import Look
from voltcam_lab.distances import FrameLight
from voltcam_simulator import EVENT

WIDTH, HEIGHT, END_US = 24, 18, 4_000_000


def free(seed: int, count: int = 12_000) -> np.ndarray:
    """Events that depend on nothing."""
    rng = np.random.default_rng(seed)
    events = np.zeros(count, EVENT)
    events["t"] = np.sort(rng.integers(0, END_US, count))
    events["x"], events["y"] = rng.integers(0, WIDTH, count), rng.integers(0, HEIGHT, count)
    events["p"] = rng.random(count) < 0.5
    return events


def echoed(seed: int, after_us: tuple[int, int], other: bool = False, share: float = 0.3) -> np.ndarray:
    """A share of the events is followed by another of its pixel, or of the pixel at its right."""
    events, rng = free(seed), np.random.default_rng(seed + 100)
    again = events[rng.random(len(events)) < share].copy()
    again["t"] += rng.integers(*after_us, len(again))
    if other:
        again["x"] = (again["x"] + 1) % WIDTH
    both = np.concatenate([events, again[again["t"] < END_US]])
    return both[np.argsort(both["t"], kind="stable")]


def look(real: np.ndarray) -> Look:
    t_us = np.arange(0, END_US + 1, 40_000)
    light = FrameLight(np.full((len(t_us), HEIGHT, WIDTH), 90, np.uint8), t_us)
    return Look.at(real, WIDTH, HEIGHT, light)


def everything(events: np.ndarray) -> np.ndarray:
    return np.ones(len(events), bool)
