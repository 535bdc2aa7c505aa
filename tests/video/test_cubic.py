"""Monotone cubics in ln L, against scipy's."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from voltcam_video import Frame
from voltcam_video.upsample import between

DARK_DN = 20.0


def cubic(images: NDArray[Any], t_us: list[int]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Times and images of what comes out."""
    frames = [Frame(image, t) for image, t in zip(images, t_us, strict=True)]
    out = list(between(frames, "cubic"))
    return np.array([f.t_us for f in out]), np.array([f.image for f in out], np.float64)


def random_images(n: int) -> NDArray[np.float32]:
    return np.random.default_rng(3).uniform(0, 255, (n, 20, 30)).astype(np.float32)


def test_scipy_draws_the_same_curve() -> None:
    images, t_us = random_images(6), [0, 10_000, 70_000, 100_000, 101_000, 200_000]
    times_us, out = cubic(images, t_us)
    logs = PchipInterpolator(t_us, np.log(images.astype(np.float64) + DARK_DN))(times_us)
    inner = (times_us >= t_us[1]) & (times_us <= t_us[-2])  # at the ends scipy has slopes of its own
    assert inner.sum() == 4 + 3 * 3
    np.testing.assert_allclose(out[inner], np.exp(logs[inner]) - DARK_DN, atol=2e-3)


def test_no_pixel_overshoots_or_turns_between_frames() -> None:
    images, t_us = random_images(6), [0, 10_000, 70_000, 100_000, 101_000, 200_000]
    times_us, out = cubic(images, t_us)
    for start_us, end_us in pairwise(t_us):
        steps = np.diff(out[(times_us >= start_us) & (times_us <= end_us)], axis=0)
        assert len(steps) == 4
        assert np.all((steps >= -1e-3).all(axis=0) | (steps <= 1e-3).all(axis=0))


def test_a_flickering_light_is_followed_better_than_by_chords() -> None:
    """8 Hz at 60 fps, the flicker of the built-in scene."""

    def light(t_us: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.exp(4.5 + 0.8 * np.sin(2e-6 * np.pi * 8 * t_us)) - DARK_DN

    t_us = [round(i * 1e6 / 60) for i in range(31)]
    grey = light(np.array(t_us, np.float64)).astype(np.float32)
    times_us, out = cubic(grey[:, None, None], t_us)
    truth = light(times_us.astype(np.float64))
    inner = (times_us > t_us[1]) & (times_us < t_us[-2])
    chord = np.exp(np.interp(times_us, t_us, np.log(grey + DARK_DN))) - DARK_DN
    error = np.log((out[:, 0, 0] + DARK_DN) / (truth + DARK_DN))[inner]
    assert np.sqrt(np.mean(error**2)) < 0.6 * np.sqrt(
        np.mean(np.log((chord + DARK_DN) / (truth + DARK_DN))[inner] ** 2)
    )


@pytest.mark.parametrize("growth", [1.0, 1.1])
def test_nothing_comes_between_where_all_lines_are_straight(growth: float) -> None:
    images = (100 * growth ** np.arange(6)[:, None, None] - DARK_DN).astype(np.float32)
    assert cubic(images, [1000 * i for i in range(6)])[0].tolist() == [1000 * i for i in range(6)]


def test_black_stays_black_and_white_white() -> None:
    images = np.array([0, 255, 0, 0, 255, 255], np.uint8)[:, None, None]
    _, out = cubic(images, [1000 * i for i in range(6)])
    assert out.min() == 0
    assert out.max() == pytest.approx(255, abs=1e-3)
