"""`voltcam serve`: what is heard of its settings, and errors in one line."""

import socket
from pathlib import Path

import pytest
from tests.ports import free_port

from .process import Daemon, voltcam


def test_a_port_in_use_is_one_line_that_names_the_flag(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        address = f"127.0.0.1:{taken.getsockname()[1]}"
        free = f"127.0.0.1:{free_port()}"
        http = voltcam("serve", "--http", address, "--zmq", f"tcp://{free}")
        zeromq = voltcam("serve", "--http", free, "--zmq", f"tcp://{address}")
    for done, flag in ((http, "--http"), (zeromq, "--zmq")):
        assert done.returncode == 1
        assert address in done.stderr
        assert "in use" in done.stderr
        assert flag in done.stderr
        assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--source", "none.mp4"], "none.mp4"),
        (["--source", "/dev/video99"], "/dev/video99: no such device"),
        (["--http", "8560"], "command line: http: "),
        (["--http", "127.0.0.1:99999"], "127.0.0.1:99999"),
        (["--http", "no.such.host.invalid:80"], "no.such.host.invalid:80"),
        (["--set", "comparator.theta_on=0"], "command line: parameters.comparator.theta_on: "),
        (["--set", "nonsense"], "--set nonsense: give it as effect.name=value"),
        (["--config", "none.yaml"], "none.yaml cannot be read"),
        (["--record", "out.mp3"], "'.mp3'"),
        (["--fps", "fast"], "command line: source.fps: "),
    ],
)
def test_what_cannot_be_is_one_line(arguments: list[str], words: str) -> None:
    done = voltcam("serve", "--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0", *arguments)
    assert done.returncode == 1
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr


def test_the_environment_and_the_file_are_heard(tmp_path: Path) -> None:
    config = tmp_path / "voltcam.yaml"
    config.write_text("camera: davis240c\nseed: 7\n")
    with Daemon("--config", str(config), "--set", "temperature_c=50") as daemon:
        camera = daemon.get("camera")
        assert (camera["name"], camera["seed"]) == ("davis240c", 7)
        assert daemon.get("parameters")["parameters"]["temperature_c"] == 50
        assert "davis240c" in daemon.banner
    assert "environment: seed: " in voltcam("serve", VOLTCAM_SEED="many").stderr


def test_help_reads_well() -> None:
    done = voltcam("serve", "--help")
    assert done.returncode == 0
    assert "example" in done.stdout
