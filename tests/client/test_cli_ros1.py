"""Arguments of `voltcam ros1`; what it does is in ros1/test_bridge.py."""

import argparse
from pathlib import Path

import pytest
from tests.client.commands import assert_one_line
from tests.ports import free_port

from voltcam_client import cli, cli_ros1


@pytest.mark.parametrize(
    "words",
    [
        ["tcp://a:1", "--clock", "dvs/events:=/e", "__name:=eye"],
        ["dvs/events:=/e", "tcp://a:1", "__name:=eye", "--clock"],
        ["--clock", "dvs/events:=/e", "__name:=eye", "tcp://a:1"],
    ],
)
def test_remappings_stand_anywhere(words: list[str]) -> None:
    parser = argparse.ArgumentParser()
    cli_ros1.configure(parser)
    args = parser.parse_args(words)
    assert (args.url, args.clock) == ("tcp://a:1", True)
    assert args.remappings == ["dvs/events:=/e", "__name:=eye"]


def test_a_file_that_is_not_there_is_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert cli.main(["ros1", "--camera-info", str(tmp_path / "none.yaml")]) == 1
    assert_one_line(error := capsys.readouterr().err)
    assert "none.yaml" in error


def test_no_roscore_is_said_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{free_port()}")
    assert cli.main(["ros1"]) == 1
    assert_one_line(error := capsys.readouterr().err)
    assert "no roscore (nobody answers at http://127.0.0.1" in error
    assert "set ROS_MASTER_URI" in error
