"""What frames tell of the light at an event."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.distances.made import WHOLE, still_light

from voltcam_lab.distances import (
    FrameLight,
)
from voltcam_lab.distances.counts import still_seconds


@pytest.fixture
def light() -> FrameLight:
    """Three frames, 10 and 30 ms apart, each pixel with a grey level of its own."""
    images = np.random.default_rng(1).integers(0, 256, (3, 4, 5)).astype(np.uint8)
    return FrameLight(images, np.array([1000, 11_000, 41_000]))


def test_brightness_and_speed_are_those_of_the_frames_about_it(light: FrameLight) -> None:
    t_us = np.array([1000, 10_999, 11_000, 40_999])
    x, y = np.array([0, 4, 2, 3], np.uint16), np.array([3, 0, 1, 2], np.uint16)
    brightness, speed = light.brightness(t_us, x, y), light.speed(t_us, x, y)
    for i, before in enumerate((0, 0, 1, 1)):
        a, b = (float(light.images[k, y[i], x[i]]) for k in (before, before + 1))
        assert brightness[i] == (a + b) / 2
        assert speed[i] == pytest.approx(abs(np.log((b + 20) / (a + 20))) / (0.01, 0.03)[before])


def test_times_outside_belong_to_the_nearest_interval(light: FrameLight) -> None:
    assert light.interval_of(np.array([-5, 999, 1000, 41_000, 99_000])).tolist() == [0, 0, 0, 1, 1]


def test_still_seconds_are_still_pixels_times_live_time() -> None:
    light = still_light(frames=11)
    images = light.images.copy()
    images[5, :, :10] = 250
    light = replace(light, images=images)
    region = WHOLE.without(np.array([[0, 80_000]]))
    period_us = int(light.t_us[1])
    live_s = np.full(10, period_us * 1e-6)
    live_s[0] -= 0.08
    assert still_seconds(region, light) == pytest.approx(light.still.sum(axis=(1, 2)) * live_s)
    assert not light.still[4:6, :, :10].any()
    assert light.still[:, :, 40:].all()
