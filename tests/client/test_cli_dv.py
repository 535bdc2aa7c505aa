"""`voltcam dv run` without dv-processing; what it does with it is in dv/test_drop_in.py."""

import builtins
from pathlib import Path
from typing import Any

import pytest
from tests.client.commands import assert_one_line

from voltcam_client import cli


def test_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **named: Any) -> Any:
        if name == "dv_processing":
            raise ModuleNotFoundError(name)
        return real(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    (tmp_path / "a.py").write_text("")
    assert cli.main(["dv", "run", str(tmp_path / "a.py")]) == 1
    error = capsys.readouterr().err
    assert_one_line(error)
    assert "pip install 'voltcam[dv]'" in error
