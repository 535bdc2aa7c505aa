"""Events that are locked to the frames."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.health.made import HEIGHT, PERIOD_US, WIDTH, frame_locked, healthy, some_events, with_events

from voltcam_lab.health import inspect


def test_bursts_locked_to_the_frames() -> None:
    recording = frame_locked(rows_us=0)
    health = inspect(recording).health
    (window,) = health["frame-locked events"].numbers["windows"]
    assert (window["begin_us"], window["end_us"]) == (
        pytest.approx(400, abs=100),
        pytest.approx(700, abs=100),
    )
    assert window["on"] > 5 > 2 > window["off"]
    assert health["row readout"].numbers["us_per_row"] is None
    mask = inspect(recording).exposure_windows
    assert mask.dtype == np.int64
    np.testing.assert_array_equal(mask[:, 0], recording.frame_t_us + window["begin_us"])
    np.testing.assert_array_equal(mask[:, 1], recording.frame_t_us + window["end_us"])


@pytest.mark.parametrize("seed", range(10, 15))
def test_no_burst_is_seen_where_there_is_none(seed: int) -> None:
    """At most one recording in a hundred has one."""
    assert inspect(healthy(2.0, seed)).exposure_windows.shape == (0, 2)


def test_the_lull_behind_a_burst_is_left_out_with_it() -> None:
    """For half the period nearly nothing comes: that is no usual time, and the other half no burst."""
    recording = frame_locked(rows_us=0)
    since_us = (recording.events["t"] - recording.frame_t_us[0]) % PERIOD_US
    quiet = (since_us > 800) & (since_us < 13_300)
    kept = ~quiet | (np.random.default_rng(2).random(quiet.size) < 0.1)
    found = inspect(replace(recording, events=recording.events[kept])).exposure_windows
    masked = np.zeros(PERIOD_US, bool)
    for begin_us, end_us in (found[5:] - recording.frame_t_us[0]).tolist():
        masked[np.arange(begin_us, end_us) % PERIOD_US] = True
    assert masked[900:13_200].mean() > 0.95
    assert masked[15_000:].mean() < 0.05


def test_where_all_rows_are_left_out_nothing_else_is_unusual() -> None:
    """Bursts of rows are longer than their scan: for three milliseconds no row is left to tell anything."""
    rng = np.random.default_rng(7)
    frames = np.repeat(healthy().frame_t_us, 400)
    y = rng.integers(0, HEIGHT, frames.size)
    t_us = frames + 20 * y + rng.integers(0, 4000, frames.size)
    found = inspect(with_events(healthy(), some_events(t_us, rng.integers(0, WIDTH, frames.size), y, True)))
    assert found.row_time_us == pytest.approx(20, abs=3)
    span = int(frames[0]), int(frames[-1])
    assert 4000 / PERIOD_US < found.mask.share(*span) < 0.3


def test_rows_of_an_empty_sky_are_not_missed() -> None:
    """Bursts that run over empty rows leave all events their time: as many as usual are not more."""
    scene = healthy()
    seen = (scene.events["y"] >= HEIGHT // 2) | (np.random.default_rng(3).random(scene.events.size) < 0.02)
    rng = np.random.default_rng(7)
    frames = np.repeat(scene.frame_t_us, 800)
    y = rng.integers(0, HEIGHT, frames.size)
    t_us = frames + 150 * y + rng.integers(0, 3000, frames.size)
    bursts = some_events(t_us, rng.integers(0, WIDTH, frames.size), y, True)
    mask = inspect(with_events(replace(scene, events=scene.events[seen]), bursts)).mask
    assert mask.us_per_row == pytest.approx(150, abs=3)
    assert mask.windows.size == 0
