"""`voltcam serve`, `convert` and `schema`: what the command line comes to, and errors in one line."""

import argparse
import socket
from pathlib import Path
from typing import Any

import pytest
from tests.ports import free_port

from voltcam_server import cli

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


def test_help_reads_well_and_the_schema_is_json() -> None:
    for command in ("serve", "convert", "schema"):
        done = voltcam(command, "--help")
        assert done.returncode == 0
        assert "example" in done.stdout
    assert voltcam("schema").stdout.startswith("{")


def given(command: Any, *arguments: str) -> dict[str, Any]:
    """The settings that a command line stands for."""
    parser = argparse.ArgumentParser()
    command(parser)
    return cli._given(parser.parse_args(arguments))


@pytest.mark.parametrize(
    ("arguments", "content"),
    [
        ((), {}),
        (("--camera", "paper", "--seed", "7"), {"camera": "paper", "seed": "7"}),
        (("--law", "paper"), {"law": "paper"}),
        (("--source", "0", "--width", "640", "--pixel-format", "MJPG"),
         {"source": {"uri": "0", "width": "640", "pixel_format": "MJPG"}}),
        (("--source", "a.mp4", "--loop"), {"source": {"uri": "a.mp4", "loop": True}}),
        (("--fast",), {"source": {"pace": "fast"}}),
        (("--burst", "--encoding", "evt3"), {"packets": {"smooth": False}, "encoding": "evt3"}),
        (("--set", "temperature_c=40", "--set", "comparator.theta_on=2", "--set", "comparator.theta_off=3"),
         {"parameters": {"temperature_c": 40, "comparator": {"theta_on": 2, "theta_off": 3}}}),
        (("--http", "127.0.0.1:1", "--zmq", "ipc:///x"), {"http": "127.0.0.1:1", "zmq": "ipc:///x"}),
    ],
)  # fmt: skip
def test_only_what_is_said_is_laid_over_the_file(arguments: tuple[str, ...], content: dict[str, Any]) -> None:
    """A value that was not given must not hide one of the config file."""
    assert given(cli.serve, *arguments) == content


def test_what_is_converted_is_read_fast() -> None:
    content = given(cli.convert, "a.mp4", "out.npz", "--fit", "stretch", "--upsample", "3")
    assert content == {"source": {"uri": "a.mp4", "fit": "stretch", "pace": "fast"}, "upsample": "3"}
