"""Frames and events on one clock, or not."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.health.made import (
    HEIGHT,
    LATENCY_US,
    START_US,
    WIDTH,
    healthy,
    only_fatal,
    some_events,
    well,
    with_events,
)

from voltcam_lab.health import inspect


@pytest.mark.parametrize("offset_us", [-400_000, 150_000, 700_000])
def test_different_clocks_that_overlap(offset_us: int) -> None:
    recording = healthy()
    shifted = replace(recording, frame_t_us=recording.frame_t_us - offset_us)
    health = only_fatal(shifted, "clock", "shift the frames' times by it")
    assert health["clock"].numbers["lag_us"] == pytest.approx(offset_us + LATENCY_US, abs=6000)


def test_the_lag_is_that_of_the_pixel() -> None:
    """The latency, less the half millisecond by which events are spread before it."""
    numbers = well().health["clock"].numbers
    assert numbers["lag_us"] == pytest.approx(LATENCY_US - 500, abs=2000)
    assert numbers["uncertainty_us"] < 5000


def test_leak_where_the_light_moves_does_not_hide_the_clock() -> None:
    """It may be many times that of the pixels at rest, where these are dark."""
    rng, recording = np.random.default_rng(2), healthy()
    t_us = START_US + rng.integers(0, 4_000_000, 60_000)
    x, y = rng.integers(WIDTH // 2, WIDTH, t_us.size), rng.integers(0, HEIGHT, t_us.size)
    health = inspect(with_events(recording, some_events(t_us, x, y, True))).health
    assert health.usable
    assert health["clock"].numbers["lag_us"] == pytest.approx(LATENCY_US, abs=3000)


def test_polarities_that_are_exchanged() -> None:
    recording = healthy()
    events = recording.events.copy()
    events["p"] = ~events["p"]
    only_fatal(replace(recording, events=events), "clock", "ON and OFF exchanged")


def test_events_of_another_scene() -> None:
    recording = healthy()
    events = recording.events.copy()
    permutation = np.random.default_rng(2).permutation(WIDTH * HEIGHT)
    pixel = permutation[events["y"].astype(int) * WIDTH + events["x"]]
    events["y"], events["x"] = np.divmod(pixel, WIDTH)
    events["t"] = 2 * START_US + 4_000_000 - events["t"]
    only_fatal(replace(recording, events=events[::-1]), "clock", "not of one scene")
