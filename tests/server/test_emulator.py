"""The loop, in process: what goes in against what comes out."""

import threading
from pathlib import Path

import numpy as np
import pytest

from voltcam_server.camera_settings import PacketSettings
from voltcam_server.emulator import Emulator
from voltcam_server.problems import UsageError
from voltcam_server.recorder import RecordingPlan
from voltcam_simulator import Simulator
from voltcam_video import SourceRequest

from .rig import (
    PATIENCE_S,
    SCENE,
    Listener,
    emulating,
    gap_free,
    in_order,
    moving_frames,
    save_frames,
    tiny,
    until,
)
from .test_simulation import SILENT


def test_a_recording_read_fast_comes_out_whole(tmp_path: Path) -> None:
    camera = tiny()
    frames = moving_frames(60, camera)
    source = SourceRequest(uri=save_frames(tmp_path / "in.npz", frames, start_us=500), pace="fast")
    with emulating(source, camera, seed=4) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) == 60)
        until(lambda: emulator.source.state == "ended", "the source ends")
        status = emulator.status
    simulator = Simulator(24, 16, camera.parameters, seed=4)
    expected = [simulator.advance(image, 500 + 10_000 * i) for i, image in enumerate(frames)]
    np.testing.assert_array_equal(listener.events, np.concatenate(expected))
    assert gap_free(listener)
    assert [frame.seq for frame in listener.frames] == list(range(60))
    assert [frame.t_us for frame in listener.frames] == [500 + 10_000 * i for i in range(60)]
    np.testing.assert_array_equal(listener.frames[7].image, frames[7])
    assert (status.frames.received, status.frames.simulated, status.frames.dropped) == (60, 60, 0)
    assert status.events.total == listener.events.size
    assert status.packets.total == len(listener.packets)


@pytest.mark.parametrize("smooth", [True, False])
def test_a_live_scene_flows(smooth: bool) -> None:
    with emulating(SCENE, packets=PacketSettings(smooth=smooth)) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) >= 30)
        assert emulator.ready
    assert gap_free(listener)
    assert in_order(listener)
    assert listener.events.size > 100
    events = listener.events
    assert events["x"].max() < 24
    assert events["y"].max() < 16
    for packet in listener.packets:
        if smooth and packet.events.size:
            assert packet.events["t"][-1] - packet.time_base_ns // 1000 <= 1000
    if not smooth:  # one packet for each frame: the first frame ends no interval, its packet is empty
        assert abs(len(listener.packets) - len(listener.frames)) <= 1


def test_a_scene_that_stands_still_still_sends(tmp_path: Path) -> None:
    """An empty packet for each interval: a subscriber sees that time goes on."""
    uri = save_frames(tmp_path / "still.npz", np.full((20, 16, 24), 90, np.uint8))
    with emulating(SourceRequest(uri=uri, pace="fast"), tiny(**SILENT)) as (_, listener):
        listener.wait(lambda it: len(it.packets) == 20)
    assert gap_free(listener)
    assert [packet.time_base_ns // 1000 for packet in listener.packets] == [0, *range(0, 190_000, 10_000)]


def test_when_the_simulation_is_slow_the_newest_frame_wins(monkeypatch: pytest.MonkeyPatch) -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        follow, slow = emulator.simulation.follow, threading.Event()
        monkeypatch.setattr(emulator.simulation, "follow", lambda *given: (slow.wait(), follow(*given))[1])
        dropped = emulator.status.frames.dropped
        until(lambda: emulator.status.frames.dropped >= dropped + 20, "frames are dropped")
        slow.set()
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 4)
    assert listener.packets[-1].dropped >= dropped + 20
    assert gap_free(listener)
    assert in_order(listener)
    spans = np.diff([frame.t_us for frame in listener.frames])
    assert spans.max() > 100_000  # what was dropped and skipped
    status, waited = emulator.status.frames, emulator.status.waiting.frames
    assert status.received == status.simulated + status.dropped + status.skipped + waited


def test_parameters_version_marks_the_switch_exactly() -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.events.size > 100)
        assert emulator.simulation.change(SILENT)[1] == 1
        listener.wait(lambda it: sum(packet.parameters_version for packet in it.packets) >= 20)
    versions = [packet.parameters_version for packet in listener.packets]
    assert versions == sorted(versions)
    assert sum(packet.events.size for packet in listener.packets if packet.parameters_version == 0) > 100
    assert sum(packet.events.size for packet in listener.packets if packet.parameters_version == 1) == 0
    assert {frame.parameters_version for frame in listener.frames} == {0, 1}


@pytest.mark.parametrize(
    "early",
    [
        {"latency": {"jitter_us": 200}},
        {"latency": {"delay_us": -100_000}},
        {"timestamp_quantum": {"quantum_us": 10}},
        {"latency": {"jitter_us": 5000}, "timestamp_quantum": {"quantum_us": 50_000}},
    ],
)
def test_events_stamped_before_the_frame_they_follow_are_sent(early: dict[str, dict[str, float]]) -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.events.size > 100)
        for version, changes in enumerate((early, {"latency": {"delay_us": 0, "jitter_us": 0}}), start=1):
            emulator.simulation.change(changes)
            listener.wait(
                lambda it, version=version: (
                    sum(packet.parameters_version == version and packet.events.size for packet in it.packets)
                    >= 5
                )
            )
    assert gap_free(listener)
    assert in_order(listener)
    assert (np.diff([packet.time_base_ns for packet in listener.packets]) >= 0).all()
    assert (np.diff([frame.t_us for frame in listener.frames]) > 0).all()


def test_no_thread_is_left() -> None:
    before = set(threading.enumerate())
    with emulating(SCENE) as (_, listener):
        listener.wait(lambda it: it.frames)
        assert set(threading.enumerate()) > before
    until(lambda: set(threading.enumerate()) <= before, "all threads end")


def broken(*_: object) -> None:
    raise RuntimeError("a bug")


def test_an_error_of_ours_is_reported() -> None:
    failed = threading.Event()
    emulator = Emulator(tiny(), SCENE, on_failure=failed.set)
    emulator.simulation.follow = broken  # type: ignore[method-assign,assignment]
    emulator.start()
    assert failed.wait(PATIENCE_S)
    emulator.stop()
    assert repr(emulator.failure) == "RuntimeError('a bug')"


def test_an_error_of_ours_in_a_transport_is_reported_too() -> None:
    failed = threading.Event()
    listener = Listener()
    listener._send = broken  # type: ignore[method-assign,assignment]
    emulator = Emulator(tiny(), SCENE, transports=[listener], on_failure=failed.set)
    listener.start()
    emulator.start()
    assert failed.wait(PATIENCE_S)
    emulator.stop()
    listener.stop()
    assert repr(emulator.failure) == "RuntimeError('a bug')"


def test_what_has_ended_begins_nothing(tmp_path: Path) -> None:
    with emulating(SCENE) as (emulator, _):
        emulator.stop()
        with pytest.raises(UsageError, match="the daemon is ending"):
            emulator.look_at(SCENE)
        with pytest.raises(UsageError, match="the daemon is ending"):
            emulator.recordings.begin(RecordingPlan(tmp_path / "late.npz"))
    assert not list(tmp_path.iterdir())
