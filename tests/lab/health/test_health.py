"""The health report on made-up recordings that have a fault, and on the same without it."""

import json
import os
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_client.formats import Recording
from voltcam_lab.health import Health, examine, exposure_windows, hot_pixels
from voltcam_lab.recordings import load

WIDTH, HEIGHT = 64, 48
PERIOD_US = 25_000
THRESHOLD = 0.25
START_US = 1_700_000_000_000_000
LEAK_HZ = 0.5
LATENCY_US = 3000

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[4] / "shared" / "data"))


def light(t_s: float) -> np.ndarray:
    """Waves that go to and fro on the right, steps of grey at rest on the left; 25 to 200 DN."""
    y, x = np.mgrid[:HEIGHT, :WIDTH].astype(np.float64)
    shift = 6 * np.sin(2 * np.pi * 1.5 * t_s)
    moving = 85 + 30 * (np.sin((x - shift) / 2.5) + np.sin((y + 0.6 * shift + 0.3 * x) / 3.1))
    at_rest = 25 + 25 * (y // 6)
    return np.where(x < WIDTH // 2, at_rest, moving)


@cache
def healthy(seconds: float = 4.0, seed: int = 1) -> Recording:
    """An ideal pixel in steps of 1 ms, a leak, a latency; frames at 40 fps with noise."""
    rng = np.random.default_rng(seed)
    memory = np.log(light(0)) + rng.uniform(-THRESHOLD, THRESHOLD, (HEIGHT, WIDTH))
    parts = []
    for t_ms in range(1, round(1000 * seconds)):
        level = np.log(light(t_ms / 1000))
        for sign in (1, -1):
            ys, xs = np.nonzero(sign * (level - memory) >= THRESHOLD)
            memory[ys, xs] += sign * THRESHOLD
            t_us = 1000 * t_ms + rng.integers(-1000, 0, ys.size) + LATENCY_US
            parts.append(np.rec.fromarrays([t_us, xs, ys, np.full(ys.size, sign > 0)], EVENT))
    leaks = rng.poisson(LEAK_HZ * seconds * WIDTH * HEIGHT)
    columns = (rng.integers(0, n, leaks) for n in (round(1e6 * seconds), WIDTH, HEIGHT))
    parts.append(np.rec.fromarrays([*columns, np.ones(leaks)], EVENT))
    t_us = np.arange(0, round(1e6 * seconds), PERIOD_US)
    frames = np.stack([light(t / 1e6) for t in t_us]) + rng.normal(0, 1, (t_us.size, HEIGHT, WIDTH))
    return recording_of(np.concatenate(parts), np.rint(frames).clip(0, 255).astype(np.uint8), t_us)


def recording_of(events: np.ndarray, frames: np.ndarray, t_us: np.ndarray) -> Recording:
    events = np.sort(np.asarray(events, EVENT), order="t", kind="stable")
    events["t"] += START_US
    return Recording(events, WIDTH, HEIGHT, frames, t_us + START_US)


def with_events(recording: Recording, more: np.ndarray) -> Recording:
    events = np.concatenate([recording.events, more])
    return replace(recording, events=np.sort(events, order="t", kind="stable"))


def some_events(t_us: Any, x: Any, y: Any, p: Any) -> np.ndarray:
    columns = np.broadcast_arrays(t_us, x, y, p)
    return np.rec.fromarrays([column.ravel() for column in columns], EVENT)


@cache
def well() -> Health:
    return examine(healthy())


def only_fatal(health: Health, name: str, words: str) -> None:
    assert not health.usable
    assert [finding.name for finding in health.fatal] == [name]
    assert words in health[name].words
    assert health.text().startswith("This recording cannot be used: ")
    assert all("\n" not in finding.words for finding in health.findings)


def test_a_healthy_recording_can_be_used() -> None:
    health = well()
    assert health.usable
    limits = {finding.name for finding in health.findings if finding.severity == "limits"}
    assert limits == {"duration", "exposure"}  # it is short, and says nothing of exposures
    assert health.text().startswith("This recording can be used, with 2 reservations.")
    assert json.loads(json.dumps(health.as_dict()))["usable"] is True


def test_no_frames() -> None:
    events_only = replace(healthy(), frames=None, frame_t_us=None)
    only_fatal(examine(events_only), "frames", "no frames: record frames and events")
    for wants_frames in (exposure_windows, hot_pixels):
        with pytest.raises(ValueError, match="without frames"):
            wants_frames(events_only)


def test_no_events() -> None:
    only_fatal(examine(replace(healthy(), events=healthy().events[:0])), "events", "no events: switch")


def test_a_second_of_data() -> None:
    only_fatal(examine(healthy(1.0)), "duration", "1.0 s with frames and events, too short")


def test_different_clocks_that_never_meet() -> None:
    recording = healthy()
    epoch = replace(recording, frame_t_us=recording.frame_t_us - START_US)
    only_fatal(examine(epoch), "clock", "different clocks: events begin 1.7e+09 s after")


@pytest.mark.parametrize("offset_us", [-400_000, 150_000, 700_000])
def test_different_clocks_that_overlap(offset_us: int) -> None:
    recording = healthy()
    health = examine(replace(recording, frame_t_us=recording.frame_t_us - offset_us))
    only_fatal(health, "clock", "shift the frames' times by it")
    assert health["clock"].numbers["lag_us"] == pytest.approx(offset_us + LATENCY_US, abs=6000)


def test_the_lag_is_that_of_the_pixel() -> None:
    """The latency, less the half millisecond by which events are spread before it."""
    numbers = well()["clock"].numbers
    assert numbers["lag_us"] == pytest.approx(LATENCY_US - 500, abs=2000)
    assert numbers["uncertainty_us"] < 5000


def test_leak_where_the_light_moves_does_not_hide_the_clock() -> None:
    """It may be many times that of the pixels at rest, where these are dark."""
    rng, recording = np.random.default_rng(2), healthy()
    t_us = START_US + rng.integers(0, 4_000_000, 60_000)
    x, y = rng.integers(WIDTH // 2, WIDTH, t_us.size), rng.integers(0, HEIGHT, t_us.size)
    health = examine(with_events(recording, some_events(t_us, x, y, True)))
    assert health.usable
    assert health["clock"].numbers["lag_us"] == pytest.approx(LATENCY_US, abs=3000)


def test_polarities_that_are_exchanged() -> None:
    recording = healthy()
    events = recording.events.copy()
    events["p"] = ~events["p"]
    only_fatal(examine(replace(recording, events=events)), "clock", "ON and OFF exchanged")


def test_events_of_another_scene() -> None:
    recording = healthy()
    events = recording.events.copy()
    permutation = np.random.default_rng(2).permutation(WIDTH * HEIGHT)
    pixel = permutation[events["y"].astype(int) * WIDTH + events["x"]]
    events["y"], events["x"] = np.divmod(pixel, WIDTH)
    events["t"] = 2 * START_US + 4_000_000 - events["t"]
    only_fatal(examine(replace(recording, events=events[::-1])), "clock", "not of one scene")


def test_a_lens_cap() -> None:
    rng = np.random.default_rng(3)
    frames = rng.normal(3, 1, (160, HEIGHT, WIDTH)).clip(0, 255).astype(np.uint8)
    leaks = some_events(np.sort(rng.integers(0, 4_000_000, 3000)), rng.integers(0, WIDTH, 3000), 5, True)
    health = examine(recording_of(leaks, frames, np.arange(160) * PERIOD_US))
    only_fatal(health, "light", "take the lens cap off")


def test_an_image_held_still_is_of_limited_use() -> None:
    rng = np.random.default_rng(4)
    frames = (light(0) + rng.normal(0, 1, (160, HEIGHT, WIDTH))).round().astype(np.uint8)
    columns = [rng.integers(0, n, 6000) for n in (4_000_000, WIDTH, HEIGHT)]
    health = examine(recording_of(some_events(*columns, True), frames, np.arange(160) * PERIOD_US))
    assert health.usable
    assert health["light"].severity == "limits"
    answers = {item.parameters[0]: item.answer for item in health.determinations}
    assert (answers["k1"], answers["k4_per_us"]) == ("no", "yes")


def test_light_that_changes_without_events() -> None:
    recording = healthy()
    at_left = recording.events[recording.events["x"] < WIDTH // 2]
    only_fatal(examine(replace(recording, events=at_left)), "light", "the events do not follow")


def test_frames_of_another_size() -> None:
    recording = healthy()
    only_fatal(examine(replace(recording, frames=recording.frames[:, ::2])), "size", "frames are 64x24")


def test_gaps_in_the_events() -> None:
    t = healthy().events["t"] - START_US
    lost = (t > 1_000_000) & (t < 1_060_000) | (t > 2_000_000) & (t < 2_030_000)
    finding = examine(replace(healthy(), events=healthy().events[~lost]))["event gaps"]
    assert finding.severity == "limits"
    begins = [begin - START_US for begin, _ in finding.numbers["gaps_us"]]
    assert begins == pytest.approx([1_000_000, 2_000_000], abs=1000)
    assert well()["event gaps"].severity == "good"


def test_missing_frames() -> None:
    recording = healthy()
    kept = np.ones(len(recording.frames), bool)
    kept[[40, 41, 90]] = False
    thinned = replace(recording, frames=recording.frames[kept], frame_t_us=recording.frame_t_us[kept])
    health = examine(thinned)
    assert "3 frames missing in 2 places" in health["frame gaps"].words
    assert (well()["frame gaps"].severity, well()["frame rate"].severity) == ("good", "good")
    assert well()["frame rate"].numbers["fps"] == 40


def test_jitter_of_the_frames() -> None:
    recording = healthy()
    jitter_us = np.random.default_rng(5).integers(-3000, 3001, len(recording.frames))
    finding = examine(replace(recording, frame_t_us=recording.frame_t_us + jitter_us))["frame rate"]
    assert finding.severity == "limits"
    assert finding.numbers["jitter_us"] == pytest.approx(np.sqrt(2) * 6000 / np.sqrt(12), rel=0.2)


@pytest.mark.parametrize(("before_us", "meaning"), [(0, "begin"), (500, "middle"), (1000, "end")])
def test_what_a_frames_time_means(before_us: int, meaning: str) -> None:
    begin = healthy().frame_t_us - before_us
    exposure_us = np.stack([begin, begin + 1000], axis=1)
    finding = examine(replace(healthy(), exposure_us=exposure_us))["exposure"]
    assert (finding.severity, finding.numbers["meaning"]) == ("good", meaning)
    assert well()["exposure"].numbers["meaning"] == "unknown"


def test_saturation() -> None:
    frames = healthy().frames.copy()
    frames[:, :10] = 255
    finding = examine(replace(healthy(), frames=frames))["saturation"]
    assert finding.severity == "limits"
    assert finding.numbers["full_share"] == pytest.approx(10 / HEIGHT)
    assert well()["saturation"].severity == "good"


def test_hot_pixels_are_found_and_no_others() -> None:
    rng = np.random.default_rng(6)
    where = [(3, 4), (20, 30), (40, 20), (41, 20)]  # at rest, at rest, moving, and beside it
    more = [some_events(START_US + rng.integers(0, 4_000_000, 400), x, y, True) for x, y in where]
    recording = with_events(healthy(), np.concatenate(more))
    hot = hot_pixels(recording)
    assert sorted((int(x), int(y)) for y, x in zip(*np.nonzero(hot), strict=True)) == sorted(where)
    assert set(examine(recording)["hot pixels"].numbers["xy"]) == set(where)
    assert not hot_pixels(healthy()).any()


@pytest.mark.parametrize("seed", range(10, 15))
def test_no_healthy_pixel_is_hot_or_silent(seed: int) -> None:
    """At most one sensor in a hundred has one."""
    health = examine(healthy(2.0, seed))
    assert health["hot pixels"].numbers["xy"] == health["silent pixels"].numbers["xy"] == []


def test_silent_pixels_where_the_light_changed() -> None:
    events = healthy().events
    dead = (events["x"] == 45) & (events["y"] == 20) | (events["x"] == 3) & (events["y"] == 3)
    finding = examine(replace(healthy(), events=events[~dead]))["silent pixels"]
    assert finding.numbers["xy"] == [(45, 20)]  # nothing is expected of the one at rest


def frame_locked(rows_us: float, count: int = 60) -> Recording:
    """ON bursts from 400 to 700 us after each frame, later by rows_us per row."""
    rng = np.random.default_rng(7)
    frames = np.repeat(healthy().frame_t_us, count)
    y = rng.integers(0, HEIGHT, frames.size)
    t_us = frames + 400 + rng.integers(0, 300, frames.size) + np.rint(rows_us * y).astype(int)
    return with_events(healthy(), some_events(t_us, rng.integers(0, WIDTH, frames.size), y, True))


def test_bursts_locked_to_the_frames() -> None:
    recording = frame_locked(rows_us=0)
    health = examine(recording)
    (window,) = health["frame-locked events"].numbers["windows"]
    assert (window["begin_us"], window["end_us"]) == (
        pytest.approx(400, abs=100),
        pytest.approx(700, abs=100),
    )
    assert window["on"] > 5 > 2 > window["off"]
    assert health["row readout"].numbers["us_per_row"] is None
    mask = exposure_windows(recording)
    assert mask.dtype == np.int64
    np.testing.assert_array_equal(mask[:, 0], recording.frame_t_us + window["begin_us"])
    np.testing.assert_array_equal(mask[:, 1], recording.frame_t_us + window["end_us"])


def test_bursts_that_run_over_the_rows() -> None:
    health = examine(frame_locked(rows_us=150))
    assert health["row readout"].numbers["us_per_row"] == pytest.approx(150, abs=5)
    windows = health["frame-locked events"].numbers["windows"]
    assert windows[0]["begin_us"] == pytest.approx(400, abs=300)
    assert windows[-1]["end_us"] == pytest.approx(700 + 150 * HEIGHT, abs=400)


def test_rows_that_are_read_together() -> None:
    """Every millisecond's events leave row by row, 3 us apart, under one time each."""
    events = healthy().events.copy()
    events["t"] = events["t"] // 1000 * 1000 + 3 * events["y"].astype(int)
    finding = examine(replace(healthy(), events=np.sort(events, order="t", kind="stable")))["row readout"]
    assert finding.severity == "limits"
    assert finding.numbers["in_one_row"] > 0.99
    assert "rows are read together" in finding.words
    assert well()["row readout"].severity == "good"


@pytest.mark.parametrize("seed", range(10, 15))
def test_no_burst_is_seen_where_there_is_none(seed: int) -> None:
    """At most one recording in a hundred has one."""
    assert exposure_windows(healthy(2.0, seed)).shape == (0, 2)


def test_the_step_of_the_event_times() -> None:
    events = healthy().events.copy()
    events["t"] = events["t"] // 100 * 100 + 7
    finding = examine(replace(healthy(), events=events))["timestamp quantum"]
    assert (finding.severity, finding.numbers["quantum_us"]) == ("limits", 100)
    assert well()["timestamp quantum"].numbers["quantum_us"] == 1


def test_a_polarity_that_is_missing() -> None:
    events = healthy().events
    finding = examine(replace(healthy(), events=events[events["p"]]))["polarity"]
    assert finding.severity == "limits"
    assert well()["polarity"].numbers["on_share"] == pytest.approx(events["p"].mean())


def test_what_it_can_determine() -> None:
    items = {item.parameters[0]: item for item in well().determinations}
    assert {name: item.answer for name, item in items.items()} == {
        "k1": "in part",  # 40 to 130 DN move
        "theta_on": "yes",
        "k4_per_us": "yes",
        "k3": "yes",
        "period_us": "no",
        "threshold_mismatch": "yes",
        "temperature_c": "no",
    }
    rest_s = np.asarray(well()["light at rest"].numbers["rest_pixel_s"]).sum()
    assert items["k4_per_us"].numbers["on_at_rest"] == pytest.approx(LEAK_HZ * rest_s, rel=0.1)


def test_the_slider() -> None:
    """On slider_depth ON crowd 400 to 50 us before a frame stamp, OFF 550 to 1500 us after it."""
    health = examine(_real("slider_depth"))
    on, off = health["frame-locked events"].numbers["windows"]
    assert (on["begin_us"], on["end_us"]) == (pytest.approx(-400, abs=100), pytest.approx(-50, abs=100))
    assert (off["begin_us"], off["end_us"]) == (pytest.approx(550, abs=150), pytest.approx(1500, abs=150))
    assert on["on"] > 10 > on["off"]
    assert "rows are read together" in health["row readout"].words
    assert off["off"] > 2 > off["on"]
    assert health.usable


def test_the_street() -> None:
    """The same: 99.7 % of the events at rest on two row scans of 35.25 us per row; exposure 500 us."""
    health = examine(_real("davis346_street/davis346.aedat4"))
    assert health["row readout"].numbers["us_per_row"] == pytest.approx(35.25, abs=0.5)
    assert health["frame-locked events"].numbers["event_share"]["at_rest"] > 0.99
    assert health["exposure"].numbers["exposure_us"] == [500, 500]
    assert health.usable


def _real(name: str) -> Recording:
    if not (DATA / name).exists():
        pytest.skip(f"no {name} in ../shared/data or $VOLTCAM_DATA")
    return load(DATA / name)
