"""How late simulated events are beside real ones, in the region that is judged."""

import numpy as np
import pytest

from voltcam_lab.distances import Region
from voltcam_lab.evaluation.lags import REAL, lags_of, told
from voltcam_lab.health import Inspection


def test_events_that_come_later_are_later_by_as_much(inspection: Inspection) -> None:
    """By a frame period, 20 ms; half a second of 1.6 left out."""
    footage = inspection.footage
    late = footage.events.copy()
    late["t"] += 20_000
    still = footage.events[footage.events["x"] > 110][::7].copy()  # noise of light that is held
    t_us = footage.frame_t_us
    region = Region.whole(footage.width, footage.height, int(t_us[25]), int(t_us[-1]))
    found = lags_of(footage, {REAL: footage.events, "late": late, "still": still}, region)
    assert set(found) == {REAL, "late"}
    assert found["late"].lag_us - found[REAL].lag_us == pytest.approx(20_000, abs=500)
    table = told(found).splitlines()
    assert table[0] == f"| lag [ms] | {REAL} | late |"
    assert table[2].startswith(f"| | {found[REAL].lag_us / 1000:.1f} ± ")
    assert f" | {found['late'].lag_us / 1000:.1f} ± " in table[2]
    assert told({}) == ""


def test_what_has_no_events_has_no_lag(inspection: Inspection) -> None:
    footage = inspection.footage
    whole = Region.whole(footage.width, footage.height, 0, int(footage.frame_t_us[-1]))
    assert lags_of(footage, {REAL: footage.events}, whole.on(np.zeros_like(whole.pixels))) == {}
