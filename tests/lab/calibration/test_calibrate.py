"""Calibration of cameras that are known, made by a generator that shares no code with the simulator.

The whole table, 20 recordings at each frame rate, is `make calibration-table`.
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.lab.calibration.calibration_table import Row, reading_of, rows_of

from voltcam_lab.calibration.calibrate import Calibration, CalibrationError, Reading, calibrate
from voltcam_lab.health import inspect
from voltcam_lab.recordings import load
from voltcam_lab.windows import total_us

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[4] / "shared" / "data"))
DRIFT = ("k1", "k2", "k4", "k5", "theta_on", "theta_off")


@pytest.fixture(scope="module")
def fast() -> dict[str, Row]:
    """A recording of 4 s at 240 fps."""
    reading, truth = reading_of(1, 240, 4.0)
    return rows_of(calibrate(reading, 1).estimates, truth)


def test_drift_and_thresholds_are_found_to_ten_percent(fast: dict[str, Row]) -> None:
    """Errors measured over 20 recordings are a tenth of that: one to fail by chance is far below 1e-4."""
    for name in DRIFT:
        assert abs(fast[name].error) < 0.1, name
        assert fast[name].determined, name


def test_noise_is_found_within_its_interval(fast: dict[str, Row]) -> None:
    """Within twice the 90 % interval, 3.3 sd: twice, 2e-3 to fail by chance, once for this seed."""
    for name in ("k3", "k6"):
        assert abs(fast[name].error) < 2 * fast[name].wide, name


@pytest.fixture(scope="module")
def half() -> Reading:
    """4 s at 25 fps, of which a calibration may use half the pixels and half the time."""
    reading, _ = reading_of(3, 25, 4.0)
    columns = np.arange(reading.keep.shape[1])
    keep = np.broadcast_to(columns // 8 % 2 == 0, reading.keep.shape)
    masked = np.array([[t, t + 500_000] for t in range(500_000, 4_000_000, 1_000_000)])
    return replace(reading, keep=keep, masked=masked)


@pytest.fixture(scope="module")
def slow(half: Reading) -> Calibration:
    return calibrate(half, seed=3)


def test_frames_on_another_clock_change_nothing_but_the_delay(half: Reading, slow: Calibration) -> None:
    stamped_late = replace(half, scene=half.scene.later(15_000))
    found = calibrate(stamped_late, seed=3, clocks_apart_us=-15_000.0)
    assert found.estimates == slow.estimates
    delay_us = slow.parameters.latency.delay_us - 15_000
    assert found.parameters == slow.parameters.changed({"latency": {"delay_us": delay_us}})


def test_what_few_frames_do_not_determine_is_said(slow: Calibration) -> None:
    told = {one.parameter: one for one in slow.estimates}
    assert not (told["k3"].determined and told["k6"].determined)
    for one in slow.estimates:
        assert one.low <= one.value <= one.high
        assert one.determined == (one.rests_on == "data")


def test_only_the_pixels_and_times_given_are_used(slow: Calibration) -> None:
    reading = slow.reading
    seen = reading.intervals(slow.dead_us, slow.delay_us)
    assert (seen["pixel"] % 48 // 8 % 2 == 0).all()
    for time in ("start_us", "end_us"):
        inside = seen[time][(seen["end"] != 0) | (time == "start_us")]
        assert not ((inside % 1e6 >= 500_000) & (inside < 4e6)).any()


def test_too_few_events_is_a_verdict() -> None:
    reading, _ = reading_of(4, 25, 1.0)
    few = Reading(reading.events[:100], reading.scene, reading.keep, reading.masked)
    with pytest.raises(CalibrationError, match=r"too few events to calibrate: \d+ intervals"):
        calibrate(few)


@pytest.mark.skipif(
    not DATA.is_dir(), reason="no real recordings: put them in ../shared/data or $VOLTCAM_DATA"
)
def test_rows_of_the_street_lose_a_fourteenth_of_their_time() -> None:
    recording = load(DATA / "davis346_street" / "davis346.aedat4")
    span = int(recording.frame_t_us[0]), int(recording.frame_t_us[-1])
    inspection = inspect(recording)
    mask = inspection.mask
    assert mask.us_per_row == pytest.approx(35.25, abs=0.5)
    assert mask.share(*span) < 0.08 < total_us(inspection.exposure_windows) / (span[1] - span[0])
    t_us, y = recording.events["t"].astype(np.float64), recording.events["y"].astype(np.int64)
    locked = mask.start(t_us, y) < t_us
    assert 0.07 < locked.mean() < 0.2  # of all events: twice what so much time has elsewhere
