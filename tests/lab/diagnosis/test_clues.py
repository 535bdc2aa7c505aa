"""What events tell of effects that have a clock of their own."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.clues import loudest_hz, quantum


@pytest.mark.parametrize("hz", [100.0, 120.0, 73.0])
def test_the_frequency_of_flickering_light(hz: float) -> None:
    rng = np.random.default_rng(1)
    t_us = np.sort(rng.uniform(0, 5e6, 30_000))
    rises = rng.random(t_us.size) < 0.5 * (1 + 0.3 * np.cos(2 * np.pi * hz * 1e-6 * t_us))
    assert loudest_hz(t_us.astype(np.int64), rises) == pytest.approx(hz, abs=0.2)  # one period in 5 s


def test_a_lamp_that_makes_events_twice_a_period_is_not_taken_for_a_faster_one() -> None:
    rng = np.random.default_rng(2)
    phase = 2 * np.pi * np.sort(rng.uniform(0, 500, 40_000))  # of 100 Hz, 5 s
    kept = rng.random(phase.size) < np.cos(phase) ** 2
    t_us = phase[kept] / (2 * np.pi * 100) * 1e6
    assert loudest_hz(t_us.astype(np.int64), np.cos(phase[kept]) > 0) == pytest.approx(100, abs=0.2)


def test_the_tick_of_time_stamps() -> None:
    ticks = np.array([3, 8, 21, 22])
    assert quantum(200 * ticks) == 200
    assert quantum(np.array([5, 8])) == 1
    assert quantum(np.empty(0, np.int64)) == 1
