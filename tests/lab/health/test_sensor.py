"""Light, saturation, silences and rows that are read together."""

from dataclasses import replace

import numpy as np
import pytest
from tests.lab.health.made import (
    HEIGHT,
    PERIOD_US,
    START_US,
    WIDTH,
    healthy,
    only_fatal,
    recording_of,
    some_events,
    well,
)

from voltcam_lab.health import inspect


def test_a_lens_cap() -> None:
    rng = np.random.default_rng(3)
    frames = rng.normal(3, 1, (160, HEIGHT, WIDTH)).clip(0, 255).astype(np.uint8)
    leaks = some_events(np.sort(rng.integers(0, 4_000_000, 3000)), rng.integers(0, WIDTH, 3000), 5, True)
    only_fatal(recording_of(leaks, frames, np.arange(160) * PERIOD_US), "light", "take the lens cap off")


def test_light_that_changes_without_events() -> None:
    recording = healthy()
    at_left = recording.events[recording.events["x"] < WIDTH // 2]
    only_fatal(replace(recording, events=at_left), "light", "the events do not follow")


def test_gaps_in_the_events() -> None:
    t = healthy().events["t"] - START_US
    lost = (t > 1_000_000) & (t < 1_060_000) | (t > 2_000_000) & (t < 2_030_000)
    finding = inspect(replace(healthy(), events=healthy().events[~lost])).health["event gaps"]
    assert finding.severity == "limits"
    begins = [begin - START_US for begin, _ in finding.numbers["gaps_us"]]
    assert begins == pytest.approx([1_000_000, 2_000_000], abs=1000)
    assert well().health["event gaps"].severity == "good"


def test_saturation() -> None:
    frames = healthy().frames.copy()
    frames[:, :10] = 255
    finding = inspect(replace(healthy(), frames=frames)).health["saturation"]
    assert finding.severity == "limits"
    assert finding.numbers["full_share"] == pytest.approx(10 / HEIGHT)
    assert well().health["saturation"].severity == "good"


def test_frames_that_end_below_255() -> None:
    """Their brightest levels have no noise, each pixel its own; all others have."""
    rng = np.random.default_rng(2)
    frames = healthy().frames.astype(float) + rng.normal(0, 2, healthy().frames.shape)
    frames[:, :10] = 150 + rng.normal(0, 2, frames[0, :10].shape)
    finding = inspect(replace(healthy(), frames=np.rint(np.clip(frames, 1, 140)).astype(np.uint8))).health[
        "saturation"
    ]
    assert finding.severity == "limits"
    assert finding.numbers["white_dn"] == 140
    assert finding.numbers["full_share"] >= 10 / HEIGHT
    assert "are 140 or more, the white of these frames: the light there is not known" in finding.words


def test_rows_that_are_read_together() -> None:
    """Every millisecond's events leave row by row, 3 us apart, under one time each."""
    events = healthy().events.copy()
    events["t"] = events["t"] // 1000 * 1000 + 3 * events["y"].astype(int)
    finding = inspect(replace(healthy(), events=np.sort(events, order="t", kind="stable"))).health[
        "row readout"
    ]
    assert finding.severity == "limits"
    assert finding.numbers["in_one_row"] > 0.99
    assert "rows are read together" in finding.words
    assert well().health["row readout"].severity == "good"
