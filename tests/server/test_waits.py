"""Nothing waits for ever: sources that hang, stalls, a daemon that is killed."""

import os
import signal
import socket
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import read
from voltcam_server import capture
from voltcam_server.problems import UsageError
from voltcam_server.recorder import RecordingPlan
from voltcam_video import SourceError, SourceRequest

from .process import Daemon
from .rig import SCENE, emulating, moving_frames, save_frames, tiny, until

HEAVY = {"junction_leak": {"k4_per_us": 1}}


@pytest.mark.parametrize("kind", ["fifo", "fifo.npz", "descriptor", "socket"])
def test_what_may_never_answer_is_not_opened(kind: str, tmp_path: Path) -> None:
    reading, writing = os.pipe()
    path = tmp_path / kind
    if kind.startswith("fifo"):
        os.mkfifo(path)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as bound:
            bound.bind(str(path))
    uri = f"/dev/fd/{reading}" if kind == "descriptor" else str(path)
    try:
        with emulating(SCENE) as (emulator, listener):
            with pytest.raises(SourceError, match=r"neither a file nor a folder|is no camera"):
                emulator.look_at(SourceRequest(uri=uri))
            count = len(listener.frames)
            listener.wait(lambda it: len(it.frames) > count + 5)
    finally:
        os.close(reading)
        os.close(writing)


def test_while_a_source_is_opened_everything_else_can_be_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A server that answers nothing held recordings and 45 more requests, and with them the page."""
    monkeypatch.setattr(capture, "OPEN_S", 3.0)
    with socket.create_server(("127.0.0.1", 0)) as silent, emulating(SCENE) as (emulator, listener):
        request = SourceRequest(uri=f"http://127.0.0.1:{silent.getsockname()[1]}/", timeout_s=60)
        with ThreadPoolExecutor() as pool:
            opening = pool.submit(emulator.look_at, request)
            connection, _ = silent.accept()
            for _ in range(45):
                with pytest.raises(UsageError, match="being opened"):
                    emulator.look_at(request)
            emulator.recordings.begin(RecordingPlan(tmp_path / "a.npz"))
            count = len(listener.frames)
            listener.wait(lambda it: len(it.frames) > count + 5)
            emulator.recordings.end()
            with pytest.raises(SourceError, match="no frame within 3 s"):
                opening.result(20)
            connection.close()
        assert emulator.source.uri == "scene"
    assert read(tmp_path / "a.npz").events.size


def test_a_daemon_in_a_stall_ends_within_seconds_and_its_recording_is_whole(tmp_path: Path) -> None:
    """One interval takes many seconds: SIGTERM had no effect until it was done."""
    with _stalled_daemon(tmp_path) as daemon:
        daemon.http.close()
        assert daemon.end()[0] == 0  # not in the hour that the interval may take
    (recording,) = [path for path in tmp_path.iterdir() if path.name in ("walk.npz", "walk.npz.partial")]
    assert read(recording).events.size > 0


def _stalled_daemon(folder: Path) -> Daemon:
    config = folder / "voltcam.yaml"
    config.write_text(f"{{overload: {{most_events: 300000000, longest_work_s: 3600}}, recordings: {folder}}}")
    daemon = Daemon("--config", str(config), "--camera", "paper")
    daemon.http.post("recording", json={"path": "walk.npz"}).raise_for_status()
    until(lambda: daemon.get("status")["recording"]["events"] > 1000, "something is recorded")
    daemon.patch(HEAVY)
    until(lambda: daemon.get("status")["state"] == "stalled", "it stalls")
    return daemon


def test_a_child_ends_with_the_daemon_that_is_killed(tmp_path: Path) -> None:
    still = save_frames(tmp_path / "walk.npz", moving_frames(3000, tiny()))
    config = tmp_path / "voltcam.yaml"
    config.write_text(f"access: {{source_folders: [{tmp_path}]}}")
    with Daemon("--config", str(config)) as daemon:
        np.savez(
            tmp_path / "events.npz", **_events(), frames=np.load(still)["frames"], t_us=np.load(still)["t_us"]
        )
        answer = daemon.http.post("diagnosis", json={"reference": "events.npz"})
        assert answer.status_code == 201, answer.text
        folder = Path(answer.json()["folder"])
        until(lambda: _children(daemon.process.pid), "it has a child")
        children = _children(daemon.process.pid)
        daemon.process.send_signal(signal.SIGKILL)
        daemon.process.wait(10)
        until(lambda: not any(Path("/proc", str(pid)).exists() for pid in children), "its children are gone")
        daemon.process.communicate()
    with Daemon("--config", str(config)) as again:
        again.http.post("diagnosis", json={"reference": "events.npz"})
        until(lambda: not folder.exists(), "the folder of the one that was killed is gone")


def _events() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    n = 20_000
    return {
        "t": np.sort(rng.integers(0, 30_000_000, n)), "x": rng.integers(0, 24, n).astype(np.uint16),
        "y": rng.integers(0, 16, n).astype(np.uint16), "p": rng.random(n) < 0.5,
    }  # fmt: skip


def _children(pid: int) -> list[int]:
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                if int((entry / "stat").read_text().rpartition(")")[2].split()[1]) == pid:
                    found.append(int(entry.name))
            except OSError:
                continue
    return found


def test_a_scene_too_large_is_refused() -> None:
    with emulating(SCENE) as (emulator, _), pytest.raises(SourceError, match="too large"):
        emulator.look_at(SourceRequest(uri="scene", width=16384, height=16384))
