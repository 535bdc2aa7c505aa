"""All of it, on a healthy recording and on real ones."""

import json
from dataclasses import replace

import pytest
from tests.lab.health.made import HEIGHT, WIDTH, healthy, real, well

from voltcam_lab.health import inspect


def test_a_healthy_recording_can_be_used() -> None:
    health = well().health
    assert health.usable
    limits = {finding.name for finding in health.findings if finding.severity == "limits"}
    assert limits == {"duration", "exposure"}  # it is short, and says nothing of exposures
    assert health.text().startswith("This recording can be used, with 2 reservations.")
    assert json.loads(json.dumps(health.as_dict()))["usable"] is True


def test_the_slider() -> None:
    """On slider_depth ON crowd 400 to 50 us before a frame stamp, OFF 550 to 1500 us after it."""
    health = inspect(real("slider_depth")).health
    on, off = health["frame-locked events"].numbers["windows"]
    assert (on["begin_us"], on["end_us"]) == (pytest.approx(-400, abs=100), pytest.approx(-50, abs=100))
    assert (off["begin_us"], off["end_us"]) == (pytest.approx(550, abs=150), pytest.approx(1500, abs=150))
    assert on["on"] > 10 > on["off"]
    assert "rows are read together" in health["row readout"].words
    assert off["off"] > 2 > off["on"]
    assert health.usable


def test_the_street() -> None:
    """The same: 99.7 % of the events at rest on two row scans of 35.25 us per row; exposure 500 us."""
    health = inspect(real("davis346_street/davis346.aedat4")).health
    assert health["row readout"].numbers["us_per_row"] == pytest.approx(35.25, abs=0.5)
    assert health["frame-locked events"].numbers["event_share"]["at_rest"] > 0.99
    assert health["exposure"].numbers["exposure_us"] == [500, 500]
    assert health.usable


def test_each_part_is_what_its_finding_says() -> None:
    found = well()
    numbers = {finding.name: finding.numbers for finding in found.health.findings}
    assert found.stamp_step_us == numbers["timestamp quantum"]["quantum_us"]
    assert found.lag.lag_us == numbers["clock"]["lag_us"]
    assert found.row_time_us == numbers["row readout"]["us_per_row"]
    assert len(found.bursts) == len(numbers["frame-locked events"]["windows"])
    assert found.hot.sum() == len(numbers["hot pixels"]["xy"])
    assert found.silent.sum() == len(numbers["silent pixels"]["xy"])
    assert found.hot.shape == found.silent.shape == (HEIGHT, WIDTH)


def test_of_frames_of_another_size_there_is_nothing_but_health() -> None:
    found = inspect(replace(healthy(), frames=healthy().frames[:, ::2]))
    assert not found.health.usable
    with pytest.raises(ValueError, match="different sizes"):
        found.mask  # noqa: B018
