"""What events tell before anything is fitted."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.clues import timestamp_tick_us

from ..made_rig import made_clues


def test_the_tick_of_time_stamps() -> None:
    ticks = np.array([3, 8, 21, 22])
    assert timestamp_tick_us(200 * ticks) == 200
    assert timestamp_tick_us(np.array([5, 8])) == 1
    assert timestamp_tick_us(np.empty(0, np.int64)) == 1


def test_sizes_and_rates_of_a_recording() -> None:
    clues = made_clues()
    assert (clues.seconds, clues.pixels, clues.tick_us) == (6.0, 48 * 36, 1)
    assert clues.peak_rate_per_s == pytest.approx(50_000)
