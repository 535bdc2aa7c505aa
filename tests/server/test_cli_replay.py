"""`voltcam replay`: a recording as a live camera, or made again."""

from pathlib import Path

import pytest

from voltcam_client.cli import main
from voltcam_client.formats import open_writer
from voltcam_server import cli_replay
from voltcam_simulator import Camera

from .process import Daemon, voltcam
from .rig import LIVELY, film, record, tiny, until


def test_the_command(tmp_path: Path) -> None:
    path = tmp_path / "walk.npz"
    camera = tiny(**LIVELY)
    record(path, film(tmp_path, camera), camera)
    done = voltcam("replay", str(path), "--verify")
    assert (done.returncode, done.stderr) == (0, "")
    assert "the same bit for bit" in done.stdout
    with Daemon("--loop", command=("replay", str(path))) as daemon:
        camera_now = daemon.get("camera")
        assert (camera_now["width"], camera_now["height"]) == (24, 16)
        until(lambda: daemon.get("status")["events"]["total"] > 100, "events")
        source = daemon.get("source")
        assert source["granted"]["kind"] == "replay"
        request = source["request"] | {"start_s": 0.2}
        assert daemon.http.put("source", json=request).is_success
        until(lambda: (daemon.get("source")["position_s"] or 0) >= 0.2, "the place it was sent to")


def test_a_daemon_is_run_with_a_camera_of_the_recording_s_size(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "walk.raw"
    open_writer(path, width=31, height=17).close()
    asked: list[object] = []

    def run_daemon(settings: dict[str, object], *more: object) -> int:
        asked.append((Camera.load(str(settings.pop("camera"))), settings, more))
        return 5

    monkeypatch.setattr(cli_replay, "run_daemon", run_daemon)
    arguments = ["replay", str(path), "--loop", "--start", "2.5", "--zmq", "tcp://127.0.0.1:0"]
    assert main(arguments) == 5
    assert main(["replay", str(path)]) == 5
    (camera, settings, more), (_, plain, _) = asked  # type: ignore[misc]
    assert (camera.name, camera.width, camera.height) == ("walk", 31, 17)
    assert settings == {
        "source": {"uri": f"replay:{path}", "loop": True, "start_s": 2.5},
        "zmq": "tcp://127.0.0.1:0",
    }
    assert more == (None, None)
    assert plain == {"source": {"uri": f"replay:{path}", "loop": False}}


def test_what_is_no_recording_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("none.npz", "walk.mp3"):
        assert main(["replay", str(tmp_path / name)]) == 1
        error = capsys.readouterr().err
        assert name in error
        assert error.count("\n") == 1


@pytest.mark.parametrize(("difference", "status"), [("", 0), ("from frame 3 on events differ", 1)])
def test_the_exit_status_says_whether_events_are_the_same(
    difference: str, status: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    verdict = type("Verdict", (), {"difference": difference, "words": "the words"})
    monkeypatch.setattr(cli_replay, "verify", lambda path: verdict)
    assert main(["replay", "walk.npz", "--verify"]) == status
    assert capsys.readouterr().out == "walk.npz: the words\n"
