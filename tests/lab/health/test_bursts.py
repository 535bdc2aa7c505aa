"""Events that are locked to the frames."""

import numpy as np
import pytest
from tests.lab.health.made import frame_locked, healthy

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
