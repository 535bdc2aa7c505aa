"""Sources that come and go while the loop runs."""

import socket
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.mjpeg_server import MjpegServer

from voltcam_server.emulator import Emulator
from voltcam_server.problems import UsageError
from voltcam_video import Clock, Frame, Granted, SourceError, SourceRequest, SourceState, watch

from .rig import (
    PATIENCE_S,
    SCENE,
    emulating,
    gap_free,
    in_order,
    moving_frames,
    save_frames,
    tiny,
    until,
)


def _bars(i: int) -> NDArray[np.uint8]:
    """Moving."""
    return np.roll(np.tile(np.repeat(np.array([40, 200], np.uint8), 8), (48, 4)), i, axis=1)


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
    server = MjpegServer(_bars)
    with emulating(SourceRequest(uri=server.url, timeout_s=1)) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) >= 5)
        server.die()
        listener.wait(lambda it: it.statuses[-1]["source"]["state"] == "reconnecting")
        assert server.url in emulator.source.message
        with pytest.raises(SourceError):  # asked for again while it is away: that does not end the waiting
            emulator.look_at(SourceRequest(uri=server.url, timeout_s=1, fit="stretch"))
        with pytest.raises(UsageError, match="nothing is being recorded"):  # it still answers
            emulator.recordings.end()
        server = MjpegServer(_bars, server.port)
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
        clock: Clock | None = None,
        open_with: object = None,
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
        clock: Clock | None = None,
        open_with: object = None,
    ) -> Iterator[Frame]:
        if granted is not None:
            on_state(SourceState("reconnecting", "/dev/video0: unplugged", granted, 1))
            stop.wait(0.1)
        return super().__call__(request, stop, on_state, granted, clock)


def test_the_old_camera_goes_on_when_it_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voltcam_server.capture.watch", UnpluggedCamera())
    with emulating(SourceRequest(uri="/dev/video0")) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        with pytest.raises(SourceError, match="busy"):
            emulator.look_at(SourceRequest(uri="/dev/video0", fps=666))
        until(lambda: emulator.source.state == "running", "the camera is back")


def test_what_is_asked_for_as_it_was_told_keeps_its_password(monkeypatch: pytest.MonkeyPatch) -> None:
    watched: list[str] = []

    def watching(request: SourceRequest, *given: Any) -> Any:
        watched.append(request.uri)
        return watch(request, *given)

    monkeypatch.setattr("voltcam_server.capture.watch", watching)
    server = MjpegServer(_bars)
    uri = server.url.replace("://", "://robot:secret@")
    with emulating(SourceRequest(uri=uri, timeout_s=5)) as (emulator, listener):
        listener.wait(lambda it: it.frames)
        told = emulator.source.request
        assert "secret" not in told.uri
        emulator.look_at(told.model_copy(update={"fit": "stretch"}))
        assert watched == [uri, uri]
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
        looking = pool.submit(emulator.look_at, SourceRequest(uri=uri, timeout_s=60))
        silent.settimeout(PATIENCE_S)
        connection, _ = silent.accept()
        began_s = time.monotonic()
        emulator.stop()
        assert time.monotonic() - began_s < PATIENCE_S  # half of what the source may take
        assert isinstance(looking.exception(), SourceError)
        connection.close()
