"""Exposures of frames, as events tell of them, or as the file says."""

import numpy as np
import pytest

from voltcam_lab.health.exposure_times import exposure_times
from voltcam_simulator import EVENT

FRAME_T_US = np.arange(0, 2_000_001, 5000)


def crowded(row_us: float, share: float = 0.2) -> np.ndarray:
    """A share of the events when exposures begin (ON) or end (OFF), at once or by rows; the rest any time."""
    rng, n = np.random.default_rng(3), 4000
    events = np.zeros(n, EVENT)
    events["y"], events["p"] = rng.integers(0, 12, n), rng.random(n) < 0.5
    frame, scattered = rng.integers(0, 399, n) * 5000, rng.random(n) > share
    kicked = frame + 1730 + np.where(events["p"], 0, 870 + row_us * events["y"])
    events["t"] = np.where(scattered, rng.integers(0, 2_000_000, n), kicked)
    return events


@pytest.mark.parametrize("row_us", [0.0, 35.25])
def test_the_exposure_from_events_that_crowd_at_its_ends(row_us: float) -> None:
    begin_us, length_us = exposure_times(crowded(row_us), FRAME_T_US, None, 35.25)
    assert begin_us % 5000 == pytest.approx(1730, abs=20)
    assert length_us == pytest.approx(870, abs=40)


def test_what_the_file_says_counts() -> None:
    exposures = np.column_stack([FRAME_T_US + 100, FRAME_T_US + 600])
    assert exposure_times(crowded(0.0), FRAME_T_US, exposures, 35.25) == (100.0, 500.0)
