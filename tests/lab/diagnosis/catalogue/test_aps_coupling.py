"""Exposures of frames, as events tell of them."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.aps_coupling import ReadoutSearch
from voltcam_simulator import EVENT

from ..made_rig import swaying


@pytest.mark.parametrize("row_us", [0.0, 35.25])
def test_the_exposure_from_events_that_crowd_at_its_ends(row_us: float) -> None:
    """Frames that nobody sees: ON events when they begin, OFF events at their end, at once or by rows."""
    rng, n = np.random.default_rng(3), 4000
    events = np.zeros(n, EVENT)
    events["y"], events["p"] = rng.integers(0, 12, n), rng.random(n) < 0.5
    frame, scattered = rng.integers(0, 399, n) * 5000, rng.random(n) < 0.8
    kicked = frame + 1730 + np.where(events["p"], 0, 870 + row_us * events["y"])
    events["t"] = np.where(scattered, rng.integers(0, 2_000_000, n), kicked)
    start_us, length_us = ReadoutSearch().exposure_of(swaying().setting, events, 35.25)
    assert start_us % 5000 == pytest.approx(1730, abs=20)
    assert length_us == pytest.approx(870, abs=40)
