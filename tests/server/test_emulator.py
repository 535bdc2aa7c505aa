"""The loop, in process: what goes in against what comes out."""

import errno
import socket
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, RecordingError, read
from voltcam_server.emulator import Emulator
from voltcam_server.problems import UsageError
from voltcam_server.recorder import QUEUE_INTERVALS
from voltcam_server.settings import PacketSettings
from voltcam_simulator import Simulator
from voltcam_video import Frame, Granted, SourceError, SourceRequest, SourceState

from .rig import PATIENCE_S, Listener, MjpegServer, emulating, moving_frames, save_frames, tiny, until
from .test_simulation import SILENT

SCENE = SourceRequest(uri="scene", fps=100, width=48, height=32, fit="stretch")


def gap_free(listener: Listener) -> bool:
    return [packet.seq for packet in listener.packets] == list(range(len(listener.packets)))


def in_order(listener: Listener) -> bool:
    return bool((np.diff(listener.events["t"]) >= 0).all())


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
        step, slow = emulator.simulation.step, threading.Event()
        monkeypatch.setattr(emulator.simulation, "step", lambda frame: (slow.wait(), step(frame))[1])
        dropped = emulator.status.frames.dropped
        until(lambda: emulator.status.frames.dropped >= dropped + 20, "frames are dropped")
        slow.set()
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 4)
    assert listener.packets[-1].dropped >= dropped + 20
    assert gap_free(listener)
    assert in_order(listener)
    spans = np.diff([frame.t_us for frame in listener.frames])
    assert spans.max() > 100_000  # one long interval in place of the frames dropped
    status = emulator.status.frames
    assert 0 <= status.received - status.simulated - status.dropped <= 1


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


def test_a_source_that_is_not_there_is_said_at_the_start(tmp_path: Path) -> None:
    emulator = Emulator(tiny(), SourceRequest(uri=str(tmp_path / "none.mp4")))
    with pytest.raises(SourceError, match=r"none\.mp4"):
        emulator.start()
    emulator.stop()


def test_another_source_takes_over_and_time_runs_on(tmp_path: Path) -> None:
    frames = moving_frames(40, tiny())
    uri = save_frames(tmp_path / "early.npz", frames)  # its clock starts at 0, long before the scene's
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) >= 5)
        emulator.look_at(SourceRequest(uri=uri, pace="fast"))
        assert emulator.source.uri == uri
        until(lambda: emulator.source.state == "ended", "the recording ends")
        listener.wait(lambda it: np.array_equal(it.frames[-1].image, frames[-1]))
        emulator.look_at(SCENE)
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 5)
    assert gap_free(listener)
    assert in_order(listener)
    assert (np.diff([frame.t_us for frame in listener.frames]) > 0).all()
    images = np.stack([frame.image for frame in listener.frames])
    (first,) = np.flatnonzero((images == frames[0]).all(axis=(1, 2)))
    np.testing.assert_array_equal(images[first : first + 40], frames)  # none of the recording's is lost


def test_a_source_that_cannot_be_opened_leaves_the_old_one_running(tmp_path: Path) -> None:
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        with pytest.raises(SourceError, match=r"none\.mp4"):
            emulator.look_at(SourceRequest(uri=str(tmp_path / "none.mp4")))
        assert emulator.source.uri == "scene"
        assert emulator.source.state == "running"
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 5)


def test_a_stream_that_dies_comes_back() -> None:
    server = MjpegServer()
    with emulating(SourceRequest(uri=server.url, timeout_s=1)) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) >= 5)
        server.die()
        listener.wait(lambda it: it.statuses[-1]["source"]["state"] == "reconnecting")
        assert server.url in emulator.source.message
        with pytest.raises(SourceError):  # asked for again while it is away: that does not end the waiting
            emulator.look_at(SourceRequest(uri=server.url, timeout_s=1, fit="stretch"))
        with pytest.raises(UsageError, match="nothing is being recorded"):  # it still answers
            emulator.end_recording()
        server = MjpegServer(server.port)
        try:
            listener.wait(lambda it: it.statuses[-1]["source"]["state"] == "running")
            count = len(listener.frames)
            listener.wait(lambda it: len(it.frames) >= count + 5)
        finally:
            emulator.stop()
            server.die()
    assert gap_free(listener)
    assert in_order(listener)


class OnlyCamera:
    """Stands in for `watch`: a camera that can be opened once at a time, and never with fps 666."""

    GRANTED = Granted(
        kind="device",
        live=True,
        width=24,
        height=16,
        fps=None,
        pixel_format=None,
        frames=None,
        backend=None,
        clock="kernel",
    )

    def __init__(self) -> None:
        self.open_count = 0

    def __call__(
        self,
        request: SourceRequest,
        stop: threading.Event,
        on_state: Callable[[SourceState], None],
        granted: Granted | None = None,
    ) -> Iterator[Frame]:
        self.open_count += 1
        try:
            if self.open_count > 1 or request.fps == 666:
                raise SourceError("/dev/video0: busy")
            on_state(SourceState("running", granted=self.GRANTED))
            while not stop.wait(0.005):
                yield Frame(np.zeros((16, 24), np.uint8), time.time_ns() // 1000)
        finally:
            self.open_count -= 1


def test_a_camera_is_let_go_before_it_is_opened_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voltcam_server.capture.watch", OnlyCamera())
    with emulating(SourceRequest(uri="/dev/video0")) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.look_at(SourceRequest(uri="/dev/video0", fps=60))
        emulator.look_at(SourceRequest(uri="0", fps=60))  # the same one
        assert emulator.source.request.fps == 60
        with pytest.raises(SourceError, match="busy"):
            emulator.look_at(SourceRequest(uri="/dev/video0", fps=666))
        until(lambda: emulator.source.state == "running", "the camera runs as before")
        assert emulator.source.request.fps == 60
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 3)


class UnpluggedCamera(OnlyCamera):
    """One that is away when it is to be opened again, and comes back."""

    def __call__(
        self,
        request: SourceRequest,
        stop: threading.Event,
        on_state: Callable[[SourceState], None],
        granted: Granted | None = None,
    ) -> Iterator[Frame]:
        if granted is not None:
            on_state(SourceState("reconnecting", "/dev/video0: unplugged", granted, 1))
            stop.wait(0.1)
        return super().__call__(request, stop, on_state, granted)


def test_the_old_camera_goes_on_when_it_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voltcam_server.capture.watch", UnpluggedCamera())
    with emulating(SourceRequest(uri="/dev/video0")) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        with pytest.raises(SourceError, match="busy"):
            emulator.look_at(SourceRequest(uri="/dev/video0", fps=666))
        until(lambda: emulator.source.state == "running", "the camera is back")


def test_what_is_asked_for_as_it_was_told_keeps_its_password() -> None:
    server = MjpegServer()
    uri = server.url.replace("://", "://robot:secret@")
    with emulating(SourceRequest(uri=uri, timeout_s=5)) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        told = emulator.source.request
        assert "secret" not in told.uri
        emulator.look_at(told.model_copy(update={"fit": "stretch"}))
        assert emulator._capture.request.uri == uri
        emulator.stop()
        server.die()


def test_ending_does_not_wait_for_a_source_that_hangs() -> None:
    with (
        socket.create_server(("127.0.0.1", 0)) as silent,
        emulating(SCENE) as (emulator, listener),
        ThreadPoolExecutor() as pool,
    ):
        listener.wait(lambda it: it.frames)
        uri = f"http://127.0.0.1:{silent.getsockname()[1]}/"
        looking = pool.submit(emulator.look_at, SourceRequest(uri=uri, timeout_s=20))
        silent.settimeout(PATIENCE_S)
        connection, _ = silent.accept()
        began_s = time.monotonic()
        emulator.stop()
        assert time.monotonic() - began_s < 10
        assert isinstance(looking.exception(), SourceError)
        connection.close()


def test_a_recording_holds_what_was_sent(tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        assert emulator.record(str(path)).recording
        with pytest.raises(UsageError, match="end that recording first"):
            emulator.record(str(tmp_path / "other.npz"))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + 10)
        done = emulator.end_recording()
        assert (done.recording, done.error) == (False, None)
        with pytest.raises(RecordingError, match="exists already"):
            emulator.record(str(path))
        with pytest.raises(FormatError, match="suffix"):
            emulator.record(str(tmp_path / "out.mp3"))
        listener.wait(lambda it: len(it.frames) >= count + 20)
    recording = read(path)
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    assert (done.events, done.frames) == (recording.events.size, len(recording.frames))
    assert len(recording.frames) >= 9
    first, last = recording.frame_t_us[0], recording.frame_t_us[-1]
    # All intervals that end at a recorded frame, and no other; the first began before its first frame.
    sent = [frame.t_us for frame in listener.frames]
    begin = sent[sent.index(first) - 1]
    assert sent[sent.index(first) : sent.index(last) + 1] == recording.frame_t_us.tolist()
    packets = [p for p in listener.packets if begin <= p.time_base_ns // 1000 < last]
    np.testing.assert_array_equal(recording.events, np.concatenate([p.events for p in packets]))


def test_a_full_disk_ends_the_recording_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out.txt"
    with emulating(SCENE) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        emulator.record(str(path))
        recorder = emulator._recorder
        assert recorder is not None
        until(lambda: recorder.status.events > 100, "events are recorded")

        def full(*_: object) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(type(recorder._writer), "_append", full)
        until(lambda: not recorder.status.recording, "the recording ends")
        status = emulator.status.recording
        assert status is not None
        assert status.error is not None
        assert "No space left" in status.error
        assert "\n" not in status.error
        with pytest.raises(RecordingError, match="exists already"):
            emulator.record(str(path))  # the stream goes on without a recorder: more frames than one holds
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) >= count + QUEUE_INTERVALS + 5)
        with pytest.raises(UsageError, match="nothing is being recorded"):
            emulator.end_recording()
    assert read(path).events.size == status.events > 100


def test_ending_the_daemon_finishes_the_recording(tmp_path: Path) -> None:
    path = tmp_path / "out.npz"
    with emulating(SCENE) as (emulator, listener):
        emulator.record(str(path))
        count = len(listener.frames)
        listener.wait(lambda it: len(it.frames) > count + 10)
    assert read(path).events.size > 0


def test_no_thread_is_left() -> None:
    before = set(threading.enumerate())
    with emulating(SCENE) as (_, listener):
        listener.wait(lambda it: it.frames)
        assert set(threading.enumerate()) > before
    until(lambda: set(threading.enumerate()) <= before, "all threads end")


def broken(_: object) -> None:
    raise RuntimeError("a bug")


def test_an_error_of_ours_is_reported() -> None:
    failed = threading.Event()
    emulator = Emulator(tiny(), SCENE, on_failure=failed.set)
    emulator.simulation.step = broken  # type: ignore[method-assign,assignment]
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
            emulator.record(str(tmp_path / "late.npz"))
    assert not list(tmp_path.iterdir())
