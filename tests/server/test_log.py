"""What the daemon says by itself: a line for each change of state, rates, and words for systemd."""

import json
import socket
import time
from pathlib import Path

import numpy as np
import pytest
from tests.ports import free_port

from voltcam_client.cli import main
from voltcam_server.log import LogSettings
from voltcam_server.recorder import RecordingStatus
from voltcam_server.status_log import StatusLog

from .rig import SCENE, Daemon, emulating, moving_frames, save_frames, tiny, until


def test_a_source_that_ends_is_a_line(tmp_path: Path) -> None:
    uri = save_frames(tmp_path / "few.npz", moving_frames(20, tiny()), 100_000)
    daemon = Daemon("--source", uri)
    until(lambda: daemon.get("status")["state"] == "ended", "it ends")
    until(lambda: daemon.http.put("source", json={"uri": "scene"}).is_success, "another source")
    until(lambda: daemon.get("status")["state"] == "running", "it runs")
    time.sleep(1.5)  # the log looks once a second
    daemon.http.close()
    assert daemon.end()[:2] == (0, "")
    lines = daemon.log.splitlines()
    assert any("WARNING ended: " in line for line in lines)
    assert any("INFO running: scene" in line for line in lines)


def test_rates_as_json(tmp_path: Path) -> None:
    config = tmp_path / "voltcam.yaml"
    config.write_text("log: {format: json, rates_s: 0.5}")
    daemon = Daemon("--config", str(config))
    until(lambda: daemon.get("status")["uptime_s"] > 4, "some seconds pass")
    daemon.http.close()
    daemon.end()
    lines = [json.loads(line) for line in daemon.log.splitlines()]
    rates = [line for line in lines if "events_per_s" in line]
    assert rates
    assert rates[-1]["fps"] > 0
    assert rates[-1]["level"] == "info"


def test_a_recording_that_fails_is_a_line(caplog: pytest.LogCaptureFixture) -> None:
    """A full disk: nothing was in any log."""
    with emulating(SCENE) as (emulator, _):
        until(lambda: emulator.status.state == "running", "it runs")
        status = emulator.status
    recording = RecordingStatus(
        path="a.npz",
        recording=False,
        files=1,
        events=5,
        frames=1,
        lost_intervals=0,
        error="a.npz: No space left",
    )
    log = StatusLog(LogSettings())
    with caplog.at_level("INFO", "voltcam"):
        for each in (status, status.model_copy(update={"recording": recording}), status):
            log.look(each)
            log.look(each)
    assert [record.getMessage() for record in caplog.records] == ["recording: a.npz: No space left"]


def test_systemd_hears_that_it_is_ready_and_lives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    address = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(str(address))
        systemd.settimeout(20)
        monkeypatch.setenv("NOTIFY_SOCKET", str(address))
        with Daemon() as daemon:
            heard = ""
            while "READY=1" not in heard or "WATCHDOG=1" not in heard or "running" not in heard:
                heard += systemd.recv(4096).decode()
            daemon.http.close()
            daemon.end()
            while "STOPPING=1" not in heard:
                heard += systemd.recv(4096).decode()


def test_a_config_file_is_checked_before_it_is_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "voltcam.yaml"
    file.write_text("camera: davis240c\nsource: {uri: /none/such.mp4}")
    assert main(["config", "check", str(file)]) == 0
    said = capsys.readouterr().out
    assert "is well" in said
    assert "240 x 180" in said
    assert "not there now" in said
    file.write_text("camera: davis240c\nhttp: 0.0.0.0:8560")
    assert main(["config", "check", str(file)]) == 1
    assert "VOLTCAM_TOKEN" in capsys.readouterr().err
    file.write_text("camra: davis240c")
    assert main(["config", "check", str(file)]) == 1
    assert "camra: there is no such key" in capsys.readouterr().err


def test_the_doctor_looks_at_ports_and_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "voltcam.yaml"
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        file.write_text(f"{{camera: ideal, http: '127.0.0.1:{port}', zmq: 'tcp://127.0.0.1:{free_port()}'}}")
        assert main(["doctor", "--config", str(file)]) == 1
    said = capsys.readouterr().out
    assert f"127.0.0.1:{port}: Address already in use; choose another with --http" in said
    assert " 30 frames/s: up to " in said
    assert np.all([line[:4].strip() in ("ok", "no", "") for line in said.splitlines()])
