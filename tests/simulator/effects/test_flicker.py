"""Flicker: a spectral line at the lamp's frequency, in both polarities, at any frame rate."""

import math

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import Events, only, watch_still

SIDE, SECONDS = 12, 1.0


def watch(fps: float, t0_us: int = 0, frequency_hz: float = 100, k1: float = 60) -> Events:
    flicker = {"frequency_hz": frequency_hz, "depth": 0.2}
    simulator = Simulator(SIDE, SIDE, only(contrast_response={"k1": k1}, flicker=flicker), seed=4)
    return watch_still(simulator, 100, SECONDS, fps, t0_us)


@pytest.mark.parametrize("fps", [7, 30, 1000])
@pytest.mark.parametrize("frequency_hz", [100, 119.88])
def test_each_period_swings_up_and_down_once_at_any_frame_rate(fps: float, frequency_hz: float) -> None:
    events = watch(fps, frequency_hz=frequency_hz)
    swing = 60 * math.log((120 + 20) / (80 + 20))  # thresholds; to turn round costs one
    for polarity in (True, False):
        count = (events["p"] == polarity).sum() / SIDE**2 / SECONDS / frequency_hz
        assert count == pytest.approx(swing - 1, rel=0.03)


@pytest.mark.parametrize("t0_us", [0, 1_763_000_000_123_457, -(10**15)])
def test_on_while_the_light_rises_and_off_while_it_falls(t0_us: int) -> None:
    """The phase is that of the time line, at any distance from its zero."""
    events = watch(30, t0_us)
    phase = (events["t"] % 10_000) / 10_000
    assert (np.cos(2 * np.pi * phase[events["p"]]) > -0.2).all()
    assert (np.cos(2 * np.pi * phase[~events["p"]]) < 0.2).all()


@pytest.mark.parametrize("turns", [0.25, -0.4])
def test_a_phase_moves_all_by_its_part_of_a_period(turns: float) -> None:
    times = []
    for phase_turns in (0.0, turns):
        flicker = {"frequency_hz": 100, "depth": 0.2, "phase_turns": phase_turns}
        simulator = Simulator(SIDE, SIDE, only(contrast_response={"k1": 60}, flicker=flicker), seed=4)
        events = watch_still(simulator, 100, SECONDS, 30)
        times.append(np.exp(2e-4j * np.pi * events["t"][events["p"]]).mean())
    moved = np.angle(times[0] / times[1]) / (2 * np.pi)  # earlier by that
    assert moved == pytest.approx(turns, abs=0.01)


def test_the_line_in_the_spectrum_is_at_its_frequency_only() -> None:
    events = watch(30, frequency_hz=120)
    for polarity in (True, False):
        t_s = events["t"][events["p"] == polarity] * 1e-6
        frequencies = np.array([30, 60, 90, 100, 120, 150])
        power = np.abs(np.exp(2j * np.pi * frequencies[:, None] * t_s).mean(axis=1)) ** 2
        assert power[4] > 0.2
        assert np.delete(power, 4).max() < 0.001


def test_without_depth_nothing_happens() -> None:
    parameters = only(contrast_response={"k1": 60}, flicker={"frequency_hz": 100, "depth": 0})
    assert len(watch_still(Simulator(SIDE, SIDE, parameters, seed=4), 100, 1, 30)) == 0
