"""`voltcam status`: the daemon's answer, flat for people or JSON for programs."""

import json

import pytest
from tests.client.commands import assert_one_line

from voltcam_client import Control, cli


def test_status_is_flat_or_json(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    status = {"source": {"uri": "webcam:0", "state": "reconnecting"}, "dropped": 3}
    monkeypatch.setattr(Control, "status", lambda self: status)
    assert cli.main(["status"]) == 0
    assert capsys.readouterr().out == "source.uri    webcam:0\nsource.state  reconnecting\ndropped       3\n"
    assert cli.main(["status", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == status


def test_status_of_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["status", "http://127.0.0.1:1"]) == 1
    assert_one_line(capsys.readouterr().err)


def test_nothing_is_shown_as_a_dash(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    status = {"recording": None, "source": {"message": ""}, "dropped": 0}
    monkeypatch.setattr("voltcam_client.control.Control.status", lambda _: status)
    assert cli.main(["status"]) == 0
    assert capsys.readouterr().out == "recording       -\nsource.message  -\ndropped         0\n"
