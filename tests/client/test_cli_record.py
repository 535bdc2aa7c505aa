"""`voltcam record`: a file that is whole, whatever ends the recording."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from tests.client.commands import COMMAND, assert_one_line, start

from voltcam_client import cli
from voltcam_client.formats import read


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("suffix", [".npz", ".raw", ".aedat4"])
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
    error = capsys.readouterr().err
    assert_one_line(error)
    assert "not tcp://127.0.0.1:1 my run.npz: quote names with blanks" in error


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


def test_record_looks_at_the_name_before_it_waits_for_a_camera(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "old.npz").write_text("kept")
    for name, words in (("a.foo", "no recording's"), ("old.npz", "exists already")):
        assert cli.main(["record", str(tmp_path / name)]) == 1
        assert words in capsys.readouterr().err


def test_nobody_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.npz"
    assert cli.main(["record", "tcp://127.0.0.1:1", str(path), "--seconds", "0.2"]) == 1
    error = capsys.readouterr().err
    assert_one_line(error)
    assert "tcp://127.0.0.1:1" in error
    assert "is `voltcam serve` running there?" in error
    assert not any(tmp_path.iterdir())
