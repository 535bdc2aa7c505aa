"""A wave that made the functions of a place is found in them."""

import numpy as np
import pytest

from voltcam_lab.dependence.covariates import COVARIATES, FINER, Look
from voltcam_lab.dependence.told_apart import Telling
from voltcam_lab.diagnosis.residual.waves import wave_of
from voltcam_lab.light.frame_light import FrameLight
from voltcam_simulator import EVENT

WIDTH, HEIGHT = 240, 180
BY_NAME = {one.name: one for one in (*COVARIATES, *FINER)}
BINS = {  # which bin a pixel is in
    "x": lambda x, y: x * 24 // WIDTH,
    "y": lambda x, y: y * 24 // HEIGHT,
    "patch": lambda x, y: (y * 6 // HEIGHT) * 8 + x * 8 // WIDTH,
    "lattice": lambda x, y: y % 4 * 4 + x % 4,
}


def told(name: str, across: float, down: float, crest: float, off: float, on: float) -> Telling:
    """Log ratios averaged over the pixels of each bin, a constant beside the wave, and uneven shares."""
    y, x = np.indices((HEIGHT, WIDTH))
    wave = np.cos(2 * np.pi * (across * x + down * y - crest)).ravel()
    bins, size = BINS[name](x, y).ravel(), BY_NAME[name].size
    mean = np.bincount(bins, wave, size) / np.bincount(bins, minlength=size)
    share = np.random.default_rng(1).uniform(0.5, 1.5, (2, size))
    return Telling(BY_NAME[name], 0.02, np.stack([0.02 + off * mean, on * mean - 0.03]), share / share.sum())


@pytest.mark.parametrize(
    ("name", "across", "down"),
    [
        ("x", 1 / 480, 0.0),  # a gradient
        ("x", 5 / 480, 0.0),
        ("y", 0.0, 7 / 360),
        ("patch", 2 / 480, -1 / 360),
        ("patch", 0.0, 3 / 360),
        ("lattice", 0.5, 0.0),  # columns that take turns
        ("lattice", 0.5, 0.5),  # a chequerboard
        ("lattice", 0.25, 0.25),
    ],
)
def test_length_crest_and_heights_of_a_wave(name: str, across: float, down: float) -> None:
    half_turns = 0.5 in (across, down)  # sine is 0 at every pixel
    crest = 0.0 if half_turns else 0.15
    wave = wave_of(told(name, across, down, crest, 0.1, -0.2), WIDTH, HEIGHT)
    assert (wave.across_per_px, wave.down_per_px) == pytest.approx((across, down))
    turned = (wave.crest_turns - crest) % 1.0
    sign = -1 if 0.25 < turned < 0.75 else 1  # half a turn on, heights have the other sign
    assert min(turned % 0.5, 0.5 - turned % 0.5) < 0.04
    assert (sign * wave.off, sign * wave.on) == pytest.approx((0.1, -0.2), rel=0.2)


def test_the_bins_of_pixels_are_those_of_the_covariates() -> None:
    """The oracle above is right: bins of the code that counts events."""
    y, x = np.indices((HEIGHT, WIDTH)).reshape(2, -1)
    events = np.zeros(x.size, EVENT)
    events["x"], events["y"] = x, y
    light = FrameLight(np.zeros((2, HEIGHT, WIDTH), np.uint8), np.array([0, 1000]))
    found = Look.at(events, WIDTH, HEIGHT, light).bins(events)
    for name, bins in BINS.items():
        assert (found[name] == bins(x, y)).all()
