"""Arguments that several commands take."""

import argparse

import pytest

from voltcam_client.cli_arguments import URL_HELP, seconds


@pytest.mark.parametrize(("text", "number"), [("0.5", 0.5), ("1e3", 1000), (" 7 ", 7)])
def test_seconds_are_a_positive_number(text: str, number: float) -> None:
    assert seconds(text) == number


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "-inf", "1e999", "soon", ""])
def test_anything_else_is_a_wrong_call_that_names_the_type(
    text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=seconds)
    with pytest.raises(SystemExit):
        parser.parse_args([f"--seconds={text}"])
    assert f"invalid seconds value: {text!r}" in capsys.readouterr().err


def test_the_help_names_the_camera_of_this_machine() -> None:
    assert "tcp://127.0.0.1:5560" in URL_HELP
