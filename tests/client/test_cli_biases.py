"""`voltcam biases`: names and numbers to a daemon, from the line or a file, and back into a file."""

from pathlib import Path
from typing import Any

import pytest
from tests.client.commands import assert_one_line

from voltcam_client import Control, cli

BIASES = {"ONBn_coarse": 6, "ONBn_fine": 200}


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What a daemon with two biases was asked to set."""
    asked: list[Any] = []

    def set_biases(_: Control, changes: dict[str, int]) -> dict[str, int]:
        asked.append(changes)
        return BIASES | changes

    monkeypatch.setattr(Control, "biases", lambda _: BIASES)
    monkeypatch.setattr(Control, "set_biases", set_biases)
    return asked


def test_they_are_printed(asked: list[Any], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["biases"]) == 0
    assert capsys.readouterr().out == "ONBn_coarse: 6\nONBn_fine: 200\n"
    assert asked == []


def test_they_are_set_from_the_line_over_a_file_and_saved(
    asked: list[Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, kept = tmp_path / "driver.yaml", tmp_path / "kept.yaml"
    file.write_text("# of a ROS driver\nONBn_fine: 90   # less\nstreaming_rate: 30\n  PrBp_coarse: 3\n")
    assert cli.main(["biases", "--load", str(file), "PrBp_coarse=2", "--save", str(kept)]) == 0
    assert asked == [{"ONBn_fine": 90, "PrBp_coarse": 2}]
    assert capsys.readouterr().out == ""
    assert cli.main(["biases", "--load", str(kept)]) == 0
    assert asked[1] == BIASES | asked[0]


@pytest.mark.parametrize("words", [["ONBn_fine"], ["ONBn_fine=-1"], ["ONBn_fine=x"], ["--load", "{}"]])
def test_what_sets_no_bias_is_said_in_a_line(
    words: list[str], asked: list[Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    empty = tmp_path / "empty.yaml"
    empty.write_text("rate: 3\n")
    assert cli.main(["biases", *(word.format(empty) for word in words)]) == 1
    error = capsys.readouterr().err
    assert_one_line(error)
    assert "ONBn_fine" in error
    assert asked == []
