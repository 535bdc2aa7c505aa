"""What a command line comes to, in the config file's layout."""

import argparse
from typing import Any

import pytest

from voltcam_server import cli_convert, cli_serve
from voltcam_server.cli_arguments import given_by


def given(command: Any, *arguments: str) -> dict[str, Any]:
    """The settings that a command line stands for."""
    parser = argparse.ArgumentParser()
    command(parser)
    return given_by(parser.parse_args(arguments))


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
    assert given(cli_serve.configure, *arguments) == content


def test_what_is_converted_is_read_fast() -> None:
    content = given(cli_convert.configure, "a.mp4", "out.npz", "--fit", "stretch", "--upsample", "3")
    assert content == {"source": {"uri": "a.mp4", "fit": "stretch", "pace": "fast"}, "upsample": "3"}
