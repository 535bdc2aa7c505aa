"""Light along a spline: at frames it is they, between them it is near to waves."""

import numpy as np
import pytest

from voltcam_lab.light.scene import How, scene_of
from voltcam_lab.light.spline import SHORTEST_US, along_spline, out_of_step

PERIOD_US, DARK_DN = 5000, 20


def wave(t_us: np.ndarray, frames_a_wave: float = 6.0) -> np.ndarray:
    """(times, 1, 16) grey levels: ln L goes up and down by 0.2, at 16 phases."""
    phase = t_us[:, None, None] / (frames_a_wave * PERIOD_US) + np.arange(16) / 16
    return 120 * np.exp(0.2 * np.sin(2 * np.pi * phase)) - DARK_DN


def error(how: How) -> float:
    """Of ln L, at most, away from the ends."""
    taken_us = PERIOD_US * np.arange(40, dtype=np.int64)
    scene = scene_of(wave(taken_us).astype(np.float32), taken_us, how)
    t_us = np.arange(25_000, 170_000, 100)
    found = np.stack([np.interp(t_us, scene.t_us, scene.images[:, 0, k]) for k in range(16)], axis=-1)
    return float(np.abs(np.log((found + DARK_DN) / (wave(t_us)[:, 0] + DARK_DN))).max())


def test_a_wave_of_six_frames_is_met_by_a_spline_only() -> None:
    assert error("spline") < 0.004
    assert error("cubic") > 0.012
    assert error("linear") == pytest.approx(0.2 * (1 - np.cos(np.pi / 6)), rel=0.15)


def test_frames_are_all_there_and_what_is_between_is_no_more_than_is_needed() -> None:
    taken_us = np.array([0, 5000, 11_000, 12_000, 30_000, 34_000])
    taken = wave(taken_us)
    images, t_us = along_spline(taken, taken_us)
    assert (np.diff(t_us) > 0).all()
    assert images[np.isin(t_us, taken_us)] == pytest.approx(taken, abs=1e-4)
    assert len(images) > len(taken)
    straight = np.full((6, 2, 3), 50.0)
    assert len(along_spline(straight, taken_us)[0]) == len(straight)


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_few_frames_have_straight_lines_between_them(frames: int) -> None:
    taken_us = PERIOD_US * np.arange(frames, dtype=np.int64)
    images, t_us = along_spline(wave(taken_us), taken_us)
    assert images == pytest.approx(wave(taken_us), abs=1e-4)
    assert t_us.tolist() == taken_us.tolist()


def test_no_light_is_less_than_none() -> None:
    taken = np.array([0, 0, 0, 200, 200, 0, 0, 0], np.float32).reshape(-1, 1, 1)
    assert along_spline(taken, PERIOD_US * np.arange(8, dtype=np.int64))[0].min() == 0


def waving(taken_us: np.ndarray, turn_us: float) -> np.ndarray:
    """(times, 1, 16) grey levels: ln L goes up and down by 0.2 in turn_us, at 16 phases."""
    return wave(taken_us, turn_us / PERIOD_US)


@pytest.mark.parametrize("period_us", [2500, 5000, 9745, 10_000, 33_333])
def test_images_out_of_step_come_at_all_phases_of_the_frames(period_us: int) -> None:
    """Each eighth of the time from frame to frame has a tenth less than an eighth of them, or more."""
    taken_us = period_us * np.arange(400, dtype=np.int64) + 777
    images, t_us = out_of_step(waving(taken_us, 12 * period_us), taken_us, monotone=False)
    assert t_us[[0, -1]].tolist() == taken_us[[0, -1]].tolist()
    assert len(images) == len(t_us)
    assert (np.diff(t_us) > 0).all()
    phases = np.histogram((t_us - 777) % period_us / period_us, 8, (0, 1))[0]
    assert phases.min() > 0.9 * phases.mean()


@pytest.mark.parametrize(("monotone", "miss"), [(False, 0.003), (True, 0.006)])
def test_images_out_of_step_are_near_the_curve_and_no_more_than_it_needs(monotone: bool, miss: float) -> None:
    """Straight lines between them meet a live video's curve, which has four chords a frame, and each frame. A
    monotone one has corners at its frames."""
    taken_us = 10_000 * np.arange(40, dtype=np.int64)
    taken = waving(taken_us, 60_000).astype(np.float32)
    images, t_us = out_of_step(taken, taken_us, monotone)
    live = scene_of(taken, taken_us, "cubic" if monotone else "spline")
    inner = (live.t_us > 20_000) & (live.t_us < 370_000)
    for k in range(16):
        met = np.interp(live.t_us[inner], t_us, images[:, 0, k])
        np.testing.assert_allclose(met, live.images[inner, 0, k], rtol=miss)
    slow = out_of_step(waving(taken_us, 2e6), taken_us, monotone)[1]
    assert len(slow) < 1.2 * len(taken) < len(t_us)


def test_chords_out_of_step_are_not_short_without_end() -> None:
    """Whatever light does between frames: at random."""
    taken_us = 10_000 * np.arange(60, dtype=np.int64)
    taken = np.random.default_rng(2).uniform(0, 255, (60, 4, 4))
    t_us = out_of_step(taken, taken_us, monotone=False)[1]
    assert np.diff(t_us).min() > 0.8 * SHORTEST_US


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_few_frames_are_all_that_is_out_of_step(frames: int) -> None:
    taken_us = PERIOD_US * np.arange(frames, dtype=np.int64)
    images, t_us = out_of_step(wave(taken_us), taken_us, monotone=False)
    assert images == pytest.approx(wave(taken_us), abs=1e-4)
    assert t_us.tolist() == taken_us.tolist()
