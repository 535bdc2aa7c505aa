"""`voltcam listen`: a line a second, and quiet ends."""

import json
import signal
from typing import Any

import pytest
from tests.client.commands import assert_one_line, start

from voltcam_client import cli


def test_listen_prints_a_line_a_second(running_camera: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["listen", running_camera, "--seconds", "1.2"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2
    assert all("events/s" in line and "0 lost" in line and "latency" in line for line in lines)


def test_listen_json(running_camera: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["listen", running_camera, "--seconds", "0.5", "--json"]) == 0
    rates: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert rates["events_per_s"] == pytest.approx(10 * rates["packets_per_s"])
    assert rates["lost_packets"] == 0


def test_listen_ends_quietly_on_ctrl_c(running_camera: str) -> None:
    process = start("listen", running_camera)
    assert process.stdout is not None
    assert "events/s" in process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=20)
    assert (process.returncode, error) == (130, "")


def test_listen_ends_quietly_when_its_reader_goes(running_camera: str) -> None:
    process = start("listen", running_camera)
    assert process.stdout is not None
    process.stdout.readline()
    process.stdout.close()
    assert process.wait(timeout=20) == 128 + signal.SIGPIPE
    assert process.stderr is not None
    assert process.stderr.read() == ""
    process.stderr.close()


def test_nobody_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["listen", "tcp://127.0.0.1:1", "--seconds", "0.2"]) == 1
    error = capsys.readouterr().err
    assert_one_line(error)
    assert "tcp://127.0.0.1:1: is `voltcam serve` running there?" in error
