"""Rows that take turns."""

import pytest
from tests.lab.health.made import HEIGHT, frame_locked

from voltcam_lab.health import inspect
from voltcam_lab.windows import total_us


def test_bursts_that_run_over_the_rows() -> None:
    health = inspect(frame_locked(rows_us=150)).health
    assert health["row readout"].numbers["us_per_row"] == pytest.approx(150, abs=1)
    windows = health["frame-locked events"].numbers["windows"]
    assert windows[0]["begin_us"] == pytest.approx(400, abs=300)
    assert windows[-1]["end_us"] == pytest.approx(700 + 150 * HEIGHT, abs=400)


def test_where_rows_take_turns_each_is_masked_in_its_own_moments() -> None:
    """300 us of bursts in a period of 25 ms, 600 us about them; for all rows at once it would be 7 ms."""
    found = inspect(frame_locked(rows_us=150))
    span = int(found.light.t_us[0]), int(found.light.t_us[-1])
    assert found.mask.us_per_row == found.row_time_us == pytest.approx(150, abs=1)
    assert found.mask.share(*span) < 0.1 < 0.25 < total_us(found.exposure_windows) / (span[1] - span[0])


def test_where_none_does_the_mask_is_the_same_for_all() -> None:
    found = inspect(frame_locked(rows_us=0))
    assert found.row_time_us is None
    assert found.mask.us_per_row == 0
    assert found.mask.windows is found.exposure_windows
