"""The `voltcam` command: its own commands, those of other packages, and errors in one line."""

import sys
from importlib import metadata
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from tests.client.commands import assert_one_line, start

from voltcam_client import cli


def entry_points(monkeypatch: pytest.MonkeyPatch, *values: str) -> None:
    entries = [EntryPoint(f"plugin{i}", value, "voltcam.commands") for i, value in enumerate(values)]
    monkeypatch.setattr(metadata, "entry_points", lambda group: entries)


def test_help_lists_every_command_and_imports_none_of_them() -> None:
    prelude = "import atexit, sys; atexit.register(lambda: print('IMPORTED', *sys.modules)); "
    help_text, _, modules = start("--help", prelude=prelude).communicate(timeout=60)[0].partition("IMPORTED")
    for name in ("listen", "record", "status", "serve", "convert", "schema"):
        assert f"\n    {name} " in help_text
    heavy = {"numba", "cv2", "fastapi", "uvicorn", "pydantic", "yaml", "voltcam_server", "voltcam_simulator"}
    assert not heavy & set(modules.split())


@pytest.mark.parametrize("command", ["listen", "record", "status"])
def test_help_of_a_command_has_examples(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        cli.main([command, "--help"])
    assert caught.value.code == 0
    assert f"\nexamples:\n  voltcam {command} " in capsys.readouterr().out


@pytest.mark.parametrize(
    "args", [[], ["bogus"], ["listen", "--seconds", "0"], ["listen", "--seconds", "nan"], ["record"]]
)
def test_a_wrong_call_exits_2(args: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        cli.main(args)
    assert caught.value.code == 2
    assert "usage: voltcam" in capsys.readouterr().err


PLUGIN = """
def configure(parser):
    parser.add_argument("word")
    parser.set_defaults(run=lambda args: len(args.word))
"""


def test_a_command_of_another_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "some_plugin.py").write_text(PLUGIN)
    monkeypatch.syspath_prepend(tmp_path)
    entry_points(monkeypatch, "some_plugin:configure", "not_there:configure [server]")
    assert cli.main(["plugin0", "abc"]) == 3


@pytest.mark.parametrize("when", ["import not_there", "def configure(parser):\n  import not_there"])
def test_a_command_whose_extra_is_missing_says_which(
    when: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "poor_plugin.py").write_text(when)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "poor_plugin", raising=False)
    entry_points(monkeypatch, "poor_plugin:configure [server]")
    assert cli.main(["plugin0"]) == 2
    error = capsys.readouterr().err
    assert_one_line(error, "voltcam plugin0 needs the server extra: pip install 'voltcam[server]'")
    assert "not_there" in error


@pytest.mark.parametrize("error", ["ValueError('two\\nlines')", "FileNotFoundError('two\\nlines')"])
def test_a_known_error_is_one_line(
    error: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad_plugin.py").write_text(f"def configure(parser):\n  raise {error}")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "bad_plugin", raising=False)
    entry_points(monkeypatch, "bad_plugin:configure")
    assert cli.main(["plugin0"]) == 1
    assert capsys.readouterr().err == "voltcam: two lines\n"
