"""The `voltcam` command, as a user meets it."""

import json
import os
import signal
import subprocess
import sys
import time
from importlib import metadata
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from voltcam_client import Control, cli
from voltcam_client.formats import read

COMMAND = [sys.executable, "-c", "import sys; from voltcam_client.cli import main; sys.exit(main())"]


def start(*args: str, prelude: str = "") -> subprocess.Popen[str]:
    command = [*COMMAND[:2], prelude + COMMAND[2], *args]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def entry_points(monkeypatch: pytest.MonkeyPatch, *values: str) -> None:
    entries = [EntryPoint(f"plugin{i}", value, "voltcam.commands") for i, value in enumerate(values)]
    monkeypatch.setattr(metadata, "entry_points", lambda group: entries)


def assert_one_line(text: str, start: str = "voltcam: ") -> None:
    assert text.startswith(start)
    assert text.count("\n") == 1


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


@pytest.mark.parametrize("args", [["listen"], ["record", "{url}", "run.npz"]])
def test_nobody_there(args: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    url = "tcp://127.0.0.1:1"
    words = [word.format(url=url) for word in args] + ([url] if len(args) == 1 else [])
    assert cli.main([*words, "--seconds", "0.2"]) == 1
    error = capsys.readouterr().err
    assert_one_line(error)
    assert url in error
    assert "is `voltcam serve` running there?" in error


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


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("suffix", [".npz", ".raw"])
def test_record_ends_well_on_a_signal(
    running_camera: str, tmp_path: Path, number: signal.Signals, suffix: str
) -> None:
    path = tmp_path / f"run{suffix}"
    under_way = tmp_path / "run.npz.partial" / "events.bin" if suffix == ".npz" else path
    process = start("record", running_camera, str(path))
    deadline = time.monotonic() + 20
    while not (under_way.exists() and under_way.stat().st_size > 2000):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(number)
    output, error = process.communicate(timeout=20)
    assert (process.returncode, error) == (0, "")
    assert_one_line(output, f"{path}: ")
    assert f" {read(path).events.size} events" in output
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_record_on_a_full_disk_keeps_what_it_has(running_camera: str, tmp_path: Path) -> None:
    path = tmp_path / "run.raw"
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000)); "
    process = start("record", running_camera, str(path), "--seconds", "30", prelude=limit)
    _, error = process.communicate(timeout=40)
    assert process.returncode == 1
    assert_one_line(error)
    events = read(path).events
    assert f"{events.size} events are safe in {path}" in error
    assert events.size > 1000


def test_record_takes_two_words_at_most(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["record", "tcp://127.0.0.1:1", "my", "run.npz"]) == 1
    assert_one_line(capsys.readouterr().err)


def test_record_shows_how_it_goes_on_a_terminal(running_camera: str, tmp_path: Path) -> None:
    reader, terminal = os.openpty()
    process = subprocess.Popen(
        [*COMMAND, "record", running_camera, str(tmp_path / "run.npz"), "--seconds", "1"],
        stdout=subprocess.DEVNULL,
        stderr=terminal,
    )
    os.close(terminal)
    assert process.wait(timeout=30) == 0
    shown = os.read(reader, 100_000).decode()
    os.close(reader)
    assert shown.count("\r\033[K") >= 3
    assert "events/s" in shown


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


def test_record_looks_at_the_name_before_it_waits_for_a_camera(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "old.npz").write_text("kept")
    for name, words in (("a.foo", "no recording's"), ("old.npz", "exists already")):
        assert cli.main(["record", str(tmp_path / name)]) == 1
        assert words in capsys.readouterr().err


def test_nothing_is_shown_as_a_dash(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    status = {"recording": None, "source": {"message": ""}, "dropped": 0}
    monkeypatch.setattr("voltcam_client.control.Control.status", lambda _: status)
    assert cli.main(["status"]) == 0
    assert capsys.readouterr().out == "recording       -\nsource.message  -\ndropped         0\n"
