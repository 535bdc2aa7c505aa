import sys
import threading
import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from voltcam_video import Frame, Granted, Source, SourceError, SourceRequest, SourceState, watch

if TYPE_CHECKING:
    from tests.mjpeg_server import MjpegServer

FRAME = Frame(np.zeros((2, 2), np.uint8), 1)
REQUEST = SourceRequest(uri="fake", timeout_s=1)


class FakeSource(Source):
    """Plays one script: frames, then the error it ends with; None ends it in silence."""

    def __init__(self, script: list[Any], live: bool) -> None:
        self.live = live
        self.granted = Granted(
            kind="device",
            live=live,
            width=2,
            height=2,
            fps=None,
            pixel_format=None,
            frames=None,
            backend=None,
            clock="kernel",
        )
        self.script = iter(script)
        self.closed = threading.Event()

    def read(self) -> Frame | None:
        item: Any = next(self.script)
        item = item() if callable(item) else item
        if isinstance(item, Exception):
            raise item
        frame: Frame | None = item
        return frame

    def close(self) -> None:
        self.closed.set()


@pytest.fixture
def opens(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[FakeSource]]:
    """Makes `watch` open these scripts one after the other; an exception is an open that fails."""

    def arrange(*scripts: list[Any] | Exception, live: bool = True) -> list[FakeSource]:
        opened: list[FakeSource] = []
        coming = iter(scripts)

        def open_source(*_: object) -> FakeSource:
            script = next(coming)
            if isinstance(script, Exception):
                raise script
            opened.append(FakeSource(script, live))
            return opened[-1]

        monkeypatch.setattr(sys.modules[watch.__module__], "open_source", open_source)
        return opened

    return arrange


class Hurried(threading.Event):
    """A stop event that only notes how long it was waited for."""

    def __init__(self) -> None:
        super().__init__()
        self.waits: list[float] = []

    def wait(self, timeout: float | None = None) -> bool:
        self.waits.append(timeout or 0)
        return self.is_set()


def test_a_recording_ends(opens: Callable[..., list[FakeSource]]) -> None:
    opened = opens([FRAME, FRAME, None], live=False)
    states: list[SourceState] = []
    frames = list(watch(REQUEST, threading.Event(), states.append))
    assert len(frames) == 2
    assert [state.state for state in states] == ["opening", "running", "ended"]
    assert states[1].granted == opened[0].granted
    assert opened[0].closed.wait(1)


def test_a_recording_that_fails_raises_after_its_frames(opens: Callable[..., list[FakeSource]]) -> None:
    opens([FRAME, SourceError("clip.mp4: ended early")], live=False)
    states: list[SourceState] = []
    frames = watch(REQUEST, threading.Event(), states.append)
    assert next(frames) is not None
    with pytest.raises(SourceError, match="ended early"):
        next(frames)
    assert (states[-1].state, states[-1].message) == ("ended", "clip.mp4: ended early")


@pytest.mark.parametrize("script", [SourceError("no such device"), [SourceError("no such device")]])
def test_a_camera_that_never_ran_raises_at_once(
    opens: Callable[..., list[FakeSource]], script: list[Any] | Exception
) -> None:
    opens(script)
    states: list[SourceState] = []
    with pytest.raises(SourceError, match="no such device"):
        next(watch(REQUEST, threading.Event(), states.append))
    assert [state.state for state in states] == ["opening", "ended"]


def test_a_camera_that_ran_is_opened_again_for_ever(opens: Callable[..., list[FakeSource]]) -> None:
    gone, failures = SourceError("unplugged"), 7
    scripts = [[FRAME, FRAME, gone], *[gone] * (failures - 1), [FRAME, FRAME, gone], [FRAME, gone]]
    opened = opens(*scripts)
    states: list[SourceState] = []
    stop = Hurried()
    frames = list(islice(watch(REQUEST, stop, states.append), 5))
    assert [frame.cut for frame in frames] == [False, False, True, False, True]
    assert stop.waits == [0.5, 1, 2, 4, 8, 10, 10, 0.5]
    attempts = [(state.state, state.attempts) for state in states]
    reconnecting = [("reconnecting", i) for i in range(1, failures + 1)]
    running = ("running", 0)
    assert attempts == [("opening", 0), running, *reconnecting, running, ("reconnecting", 1), running]
    assert all(state.message == "unplugged" for state in states if state.state == "reconnecting")
    assert all(source.closed.wait(1) for source in opened)


def test_opened_but_silent_counts_as_a_failure(opens: Callable[..., list[FakeSource]]) -> None:
    gone = SourceError("stalled")
    opens([FRAME, gone], [gone], [gone], [FRAME, gone])
    stop = Hurried()
    assert len(list(islice(watch(REQUEST, stop, lambda _: None), 2))) == 2
    assert stop.waits == [0.5, 1, 2]


def test_other_errors_are_not_hidden(opens: Callable[..., list[FakeSource]]) -> None:
    opens([FRAME, ZeroDivisionError("a bug")])
    frames = watch(REQUEST, threading.Event(), lambda _: None)
    next(frames)
    with pytest.raises(ZeroDivisionError):
        next(frames)


def test_stop_does_not_wait_for_a_read_that_hangs(opens: Callable[..., list[FakeSource]]) -> None:
    hang, stop, read = threading.Event(), threading.Event(), threading.Event()

    def hanging() -> None:
        hang.wait(60)
        read.set()

    opened = opens([FRAME, hanging])
    states: list[SourceState] = []
    frames = watch(REQUEST, stop, states.append)
    next(frames)
    stop.set()
    assert next(frames, None) is None
    assert not read.is_set()
    assert (states[-1].state, states[-1].message) == ("ended", "stopped")
    hang.set()
    assert opened[0].closed.wait(1)


def test_stop_ends_the_wait_for_the_next_attempt(opens: Callable[..., list[FakeSource]]) -> None:
    opens([FRAME, SourceError("gone")], *[SourceError("gone")] * 9)
    stop = threading.Event()
    attempts: list[int] = []

    def on_state(state: SourceState) -> None:
        attempts.append(state.attempts)
        if state.attempts == 5:  # a wait of eight seconds follows
            threading.Timer(0.1, stop.set).start()

    frames = watch(REQUEST, stop, on_state)
    next(frames)
    assert next(frames, None) is None
    assert max(attempts) == 5


def test_a_consumer_that_leaves_closes_the_source(opens: Callable[..., list[FakeSource]]) -> None:
    opened = opens([FRAME] * 100)
    frames = watch(REQUEST, threading.Event(), lambda _: None)
    next(frames)
    frames.close()  # type: ignore[attr-defined]
    assert opened[0].closed.wait(1)


def test_stop_ends_a_recordings_wait_for_its_next_frame(tmp_path: Path) -> None:
    path = tmp_path / "slow.npz"
    np.savez(path, frames=np.zeros((2, 2, 2), np.uint8), t_us=np.array([0, 3_600_000_000]))
    stop = threading.Event()
    frames = watch(SourceRequest(uri=str(path)), stop, lambda _: None)
    next(frames)
    threading.Timer(0.1, stop.set).start()
    assert next(frames, None) is None  # not in an hour


def test_realtime_keeps_the_pace(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, frames=np.zeros((6, 2, 2), np.uint8), t_us=np.arange(6) * 50_000 + 7)
    start_us = time.time_ns() // 1000
    frames = list(watch(SourceRequest(uri=str(path)), threading.Event(), lambda _: None))
    took_us = time.time_ns() // 1000 - start_us
    # A machine that hesitates may be later, never earlier; the exact times are test_recorded's.
    assert (np.diff([frame.t_us for frame in frames]) >= 50_000).all()
    assert 0 <= frames[0].t_us - start_us < 2_000_000
    assert 250_000 <= took_us < 2_000_000


def test_a_stream_comes_back_after_its_server_died_and_after_a_stall(
    mjpeg_server: Callable[..., "MjpegServer"],
) -> None:
    server = mjpeg_server()
    states: list[SourceState] = []
    stop = threading.Event()
    frames = watch(SourceRequest(uri=server.url, timeout_s=0.6), stop, states.append)
    times_us = [frame.t_us for frame in islice(frames, 5)]

    server.die()
    servers: list[MjpegServer] = []
    threading.Timer(0.3, lambda: servers.append(mjpeg_server(server.port))).start()
    back = next(frame for frame in frames if frame.cut)
    times_us.append(back.t_us)
    assert [state.state for state in states[:3]] == ["opening", "running", "reconnecting"]
    assert "the stream ended" in states[2].message
    assert states[-1].state == "running"

    servers[0].stalled.set()
    threading.Timer(1.5, servers[0].stalled.clear).start()
    times_us.append(next(frame for frame in frames if frame.cut).t_us)
    assert any("stalled" in state.message for state in states)
    assert states[-1].state == "running"
    assert times_us == sorted(times_us)
    stop.set()
    list(frames)
    assert states[-1].state == "ended"
