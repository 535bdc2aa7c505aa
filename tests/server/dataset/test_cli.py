"""`voltcam dataset` as a user types it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.server.dataset.rig import camera, clip, clips, content

from voltcam_client.cli import main
from voltcam_server.dataset.manifest import read_manifest

VOLTCAM = [sys.executable, "-c", "import sys; from voltcam_client.cli import main; sys.exit(main())"]
LIMIT_S = 120


def test_a_pattern_and_flags_make_a_set(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clips(tmp_path / "in", 2)
    out = tmp_path / "set"
    status = main([
        "dataset", "make", f"{tmp_path}/in/*.npz", str(out), "--camera", camera(tmp_path), "--variants", "2",
        "--set", "comparator.theta_on={uniform: [0.2, 0.4]}", "--set", "temperature_c=40", "--format", ".npz",
        "--no-frames", "--workers", "2", "--seed", "3",
    ])  # fmt: skip
    assert status == 0
    assert f"{out}: 4 items made, " in capsys.readouterr().out
    lines = read_manifest(out)
    assert all(line["parameters"]["temperature_c"] == 40 for line in lines)
    assert [line["path"] for line in lines[:2]] == ["items/clip0.npz.0.npz", "items/clip0.npz.1.npz"]
    assert json.loads((out / "spec.json").read_text())["seed"] == 3
    assert main(["dataset", "check", str(out)]) == 0
    assert main(["dataset", "show", str(out)]) == 0
    assert main(["dataset", "check", str(out)]) == 0, "its page is known"
    (out / lines[0]["path"]).unlink()
    assert main(["dataset", "check", str(out)]) == 1
    said = capsys.readouterr().out
    assert "items/clip0.npz.0.npz: No such file" in said
    assert "4 items in 4 files, 1 faults" in said


def test_flags_go_over_a_spec_and_a_failure_is_an_exit_status(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clips(tmp_path / "in", 1)
    clip(tmp_path / "in" / "short.npz", count=1)
    camera(tmp_path)
    (tmp_path / "spec.yaml").write_text("inputs: in/*\ncamera: tiny.yaml\nvariants: 5\n")
    make = ["dataset", "make", str(tmp_path / "spec.yaml"), str(tmp_path / "set")]
    assert main([*make, "--variants", "1", "--workers", "1"]) == 1
    said = capsys.readouterr()
    assert "1 items made" in said.out
    assert "1 could not be made, see the lines above and manifest.jsonl" in said.out
    assert "short.npz has one frame" in said.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["{}/in/*.mp4", "{}/set"], "in/*.mp4 finds nothing: correct the pattern"),
        (
            ["{}/in/*", "{}/set", "--set", "comparator.theta=1"],
            "comparator.theta: there is no such parameter",
        ),
        (["{}/in/*", "{}/set", "--set", "comparator.theta_on={uniform: [3, 1]}"], "a low and a high end"),
        (["{}/in/*", "{}/set", "--engine", "ray://a"], "--engine ray://a: give local, or dask://HOST:PORT"),
        (["{}/in/*", "{}/in/clip0.npz"], "cannot be made: File exists: give another folder"),
        (["{}/gone.yaml", "{}/set"], "gone.yaml cannot be read: No such file"),
        (["{}/gone.yaml", "{}/set", "--fps", "3"], "--fps: say it in the spec"),
    ],
)
def test_what_is_wrong_is_one_line_before_anything_is_made(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    clips(tmp_path / "in", 1)
    assert main(["dataset", "make", *(text.replace("{}", str(tmp_path)) for text in arguments)]) == 1
    [line] = [line for line in capsys.readouterr().err.splitlines() if line]
    assert line.startswith("voltcam: ")
    assert words in line
    assert not (tmp_path / "set" / "items").exists()


def test_ctrl_c_and_kill_and_the_same_command_goes_on(tmp_path: Path) -> None:
    clips(tmp_path / "in", 120)
    command = [
        *VOLTCAM, "dataset", "make", f"{tmp_path}/in/*", "--camera", camera(tmp_path), "--workers", "2",
    ]  # fmt: skip
    subprocess.run([*command, str(tmp_path / "whole")], check=True, timeout=LIMIT_S)
    for part, number, status in ((25, signal.SIGKILL, -9), (60, signal.SIGINT, 130)):
        process = subprocess.Popen([*command, str(tmp_path / "set")], stderr=subprocess.DEVNULL)
        until_s = time.monotonic() + LIMIT_S
        while _lines(tmp_path / "set") < part and time.monotonic() < until_s:
            time.sleep(0.01)
        os.kill(process.pid, number)
        assert process.wait(LIMIT_S) == status
        assert part <= _lines(tmp_path / "set") < 120
    subprocess.run([*command, str(tmp_path / "set")], check=True, timeout=LIMIT_S)
    assert content(tmp_path / "set") == content(tmp_path / "whole")


def _lines(folder: Path) -> int:
    path = folder / "manifest.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0
