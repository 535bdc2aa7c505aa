"""A recording as a live source: its own events at its own pace."""

import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.formats import open_writer
from voltcam_server.replay_source import GREY, PERIOD_US, ReplaySource, open_any
from voltcam_simulator import EVENT
from voltcam_video import Clock, Frame, SourceError, SourceRequest

from .rig import emulating, in_order, tiny, until


def some_events(count: int = 500) -> np.ndarray[Any, Any]:
    rng = np.random.default_rng(0)
    events = np.empty(count, EVENT)
    events["t"] = np.sort(rng.integers(1_000_000, 1_400_000, count))
    events["x"], events["y"] = rng.integers(0, 24, count), rng.integers(0, 16, count)
    events["p"] = rng.integers(0, 2, count)
    return events


def replay_of(path: Path, **options: Any) -> SourceRequest:
    return SourceRequest(uri=f"replay:{path}", **options)


@pytest.mark.parametrize("suffix", [".npz", ".raw", ".txt", ".aedat4"])
def test_a_replay_gives_the_recorded_events_at_their_own_pace(suffix: str, tmp_path: Path) -> None:
    path, events = tmp_path / f"walk{suffix}", some_events()
    with open_writer(path, width=24, height=16) as writer:
        writer.events(events)
    with emulating(replay_of(path), tiny()) as (emulator, listener):
        listener.wait(lambda it: len(it.events) == len(events))
        until(lambda: emulator.state[0] == "ended", "the end")
        assert in_order(listener)
        found = listener.events
    for name in "xyp":
        np.testing.assert_array_equal(found[name], events[name])
    np.testing.assert_array_equal(np.diff(found["t"]), np.diff(events["t"].astype(np.int64)))


def test_a_replay_begins_where_it_is_told_and_goes_round(tmp_path: Path) -> None:
    path, events = tmp_path / "walk.raw", some_events()
    with open_writer(path, width=24, height=16) as writer:
        writer.events(events)
    late = events[events["t"] > events["t"][0] + 300_000]
    with emulating(replay_of(path, start_s=0.3, loop=True), tiny()) as (_, listener):
        listener.wait(lambda it: len(it.events) > len(late) + len(events))
        found = listener.events
        assert in_order(listener)
    # The first frame after the beginning brings the events since the one before, up to 10 ms.
    first = int(np.flatnonzero(np.diff(found["t"].astype(np.int64)) > 0)[0])
    assert first < 40
    tail = np.flatnonzero((events["x"] == found["x"][0]) & (events["y"] == found["y"][0]))
    begin = next(i for i in tail if np.array_equal(events["x"][i:], found["x"][: len(events) - i]))
    assert abs(int(events["t"][begin]) - int(events["t"][0]) - 300_000) < 12_000
    again = found[len(events) - begin :]
    np.testing.assert_array_equal(again["x"][: len(events)], events["x"][: len(again)])


def test_a_replay_needs_a_camera_of_its_size(tmp_path: Path) -> None:
    path = tmp_path / "walk.raw"
    with open_writer(path, width=20, height=16) as writer:
        writer.events(some_events()[:0])
        events = some_events()
        events["x"] %= 20
        writer.events(events)
    with emulating(replay_of(path, loop=True), tiny()) as (emulator, _):
        until(lambda: emulator.status.frames.unusable > 0, "refused")
        assert "20 x 16 pixels needs a camera of that size" in emulator.source.message


def test_what_is_no_recording_is_said(tmp_path: Path) -> None:
    (tmp_path / "empty.raw").write_bytes(b"")
    for name in ("none.npz", "empty.raw"):
        with pytest.raises(SourceError), emulating(replay_of(tmp_path / name), tiny()):
            pass


def played(path: Path, **options: Any) -> tuple[ReplaySource, list[Frame]]:
    """At once, by the recording's own times."""
    request = replay_of(path, pace="fast", **options)
    with open_any(request, Clock(), threading.Event()) as source:
        assert isinstance(source, ReplaySource)
        return source, list(source)


def events_at(*t_us: int) -> np.ndarray[Any, Any]:
    events = np.zeros(len(t_us), EVENT)
    events["t"], events["x"] = t_us, np.arange(len(t_us))
    return events


def written(path: Path, events: np.ndarray[Any, Any], frames: dict[int, int]) -> Path:
    """frames: grey level by time."""
    with open_writer(path, width=24, height=16) as writer:
        writer.events(events)
        for t_us, grey in frames.items():
            writer.frame(np.full((16, 24), grey, np.uint8), t_us)
    return path


def test_each_frame_brings_the_events_up_to_it(tmp_path: Path) -> None:
    events = events_at(5, 100, 150, 200, 201, 299)
    path = written(tmp_path / "a.npz", events, {100: 10, 200: 20, 300: 30})
    source, frames = played(path)
    assert [frame.t_us for frame in frames] == [100, 200, 300]
    assert [int(frame.image[0, 0]) for frame in frames] == [10, 20, 30]
    found = [frame.events for frame in frames]
    assert [each["t"].tolist() for each in found if each is not None] == [[5, 100], [150, 200], [201, 299]]
    granted = source.granted
    assert (granted["kind"], granted["live"], granted["frames"]) == ("replay", False, 3)
    assert (granted["width"], granted["height"], granted["fps"]) == (24, 16, 10_000)


def test_events_after_the_last_frame_come_with_it_once_more(tmp_path: Path) -> None:
    path = written(tmp_path / "a.npz", events_at(50, 150, 170), {100: 10})
    _, frames = played(path)
    assert [(frame.t_us, int(frame.image[0, 0])) for frame in frames] == [(100, 10), (170, 10)]
    assert frames[1].events is not None
    assert frames[1].events["t"].tolist() == [150, 170]


def test_without_frames_grey_ones_come_a_hundred_times_a_second(tmp_path: Path) -> None:
    events = events_at(1000, 10_999, 11_000, 11_001, 35_000)
    _, frames = played(written(tmp_path / "a.raw", events, {}))
    assert np.diff([frame.t_us for frame in frames]).tolist() == [PERIOD_US] * 4
    assert frames[0].t_us == 1000
    assert all((frame.image == GREY).all() and frame.image.shape == (16, 24) for frame in frames)
    got = [frame.events["t"].tolist() for frame in frames if frame.events is not None]
    assert got == [[1000], [10_999, 11_000], [11_001], [], [35_000]]


def test_other_uris_are_opened_as_ever(tmp_path: Path) -> None:
    request = SourceRequest(uri="scene", width=24, height=16, fps=50, pace="fast")
    with open_any(request, Clock(), threading.Event()) as source:
        assert source.granted["kind"] == "scene"
