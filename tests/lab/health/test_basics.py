"""What is there, for how long, with which gaps and stamps."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.health.made import START_US, healthy, only_fatal, well

from voltcam_lab.health import inspect


def test_no_events() -> None:
    only_fatal(replace(healthy(), events=healthy().events[:0]), "events", "no events: switch")


def test_one_frame() -> None:
    recording = healthy()
    one = replace(recording, frames=recording.frames[:1], frame_t_us=recording.frame_t_us[:1])
    only_fatal(one, "frames", "only one frame: record")


def test_a_second_of_data() -> None:
    only_fatal(healthy(1.0), "duration", "0.974 s with frames and events, too short")


def test_different_clocks_that_never_meet() -> None:
    recording = healthy()
    epoch = replace(recording, frame_t_us=recording.frame_t_us - START_US)
    only_fatal(epoch, "clock", "different clocks: events begin 1.7e+09 s after")


def test_frames_of_another_size() -> None:
    recording = healthy()
    only_fatal(replace(recording, frames=recording.frames[:, ::2]), "size", "frames are 64x24")


def test_missing_frames() -> None:
    recording = healthy()
    kept = np.ones(len(recording.frames), bool)
    kept[[40, 41, 90]] = False
    thinned = replace(recording, frames=recording.frames[kept], frame_t_us=recording.frame_t_us[kept])
    health = inspect(thinned).health
    assert "3 frames missing in 2 places" in health["frame gaps"].words
    assert (well().health["frame gaps"].severity, well().health["frame rate"].severity) == ("good", "good")
    assert well().health["frame rate"].numbers["fps"] == 40


def test_jitter_of_the_frames() -> None:
    recording = healthy()
    jitter_us = np.random.default_rng(5).integers(-3000, 3001, len(recording.frames))
    finding = inspect(replace(recording, frame_t_us=recording.frame_t_us + jitter_us)).health["frame rate"]
    assert finding.severity == "limits"
    assert finding.numbers["jitter_us"] == pytest.approx(np.sqrt(2) * 6000 / np.sqrt(12), rel=0.2)


@pytest.mark.parametrize(("before_us", "meaning"), [(0, "begin"), (500, "middle"), (1000, "end")])
def test_what_a_frames_time_means(before_us: int, meaning: str) -> None:
    begin = healthy().frame_t_us - before_us
    exposure_us = np.stack([begin, begin + 1000], axis=1)
    finding = inspect(replace(healthy(), exposure_us=exposure_us)).health["exposure"]
    assert (finding.severity, finding.numbers["meaning"]) == ("good", meaning)
    assert well().health["exposure"].numbers["meaning"] == "unknown"


def test_the_step_of_the_event_times() -> None:
    events = healthy().events.copy()
    events["t"] = events["t"] // 100 * 100 + 7
    finding = inspect(replace(healthy(), events=events)).health["timestamp quantum"]
    assert (finding.severity, finding.numbers["quantum_us"]) == ("limits", 100)
    assert well().health["timestamp quantum"].numbers["quantum_us"] == 1


def test_a_polarity_that_is_missing() -> None:
    events = healthy().events
    finding = inspect(replace(healthy(), events=events[events["p"]])).health["polarity"]
    assert finding.severity == "limits"
    assert well().health["polarity"].numbers["on_share"] == pytest.approx(events["p"].mean())
