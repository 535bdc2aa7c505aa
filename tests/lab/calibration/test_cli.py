"""`voltcam calibrate` as a user has it, on a recording made here; and on broken ones."""

from argparse import ArgumentParser
from pathlib import Path

import numpy as np
import pytest
from tests.generator import draw_base, draw_scene, record

from voltcam_client import cli
from voltcam_client.encodings import EVENT
from voltcam_client.formats import open_writer
from voltcam_lab.calibration import cli as cli_calibrate
from voltcam_lab.calibration.calibrate import CalibrationError
from voltcam_lab.calibration.camera_from import camera_from
from voltcam_lab.health import inspect
from voltcam_lab.recordings import load
from voltcam_simulator import Camera, Simulator

SECONDS, FPS = 3.0, 120


def written(path: Path, events: np.ndarray, frames: np.ndarray, t_us: np.ndarray) -> Path:
    with open_writer(path, width=48, height=36) as writer:
        writer.events(np.asarray(events, EVENT))
        for frame, t in zip(frames, t_us.tolist(), strict=True):
            writer.frame(frame, t)
    return path


@pytest.fixture(scope="module")
def made() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(8)
    recorded = record(draw_scene(rng), draw_base(rng), seconds=SECONDS, fps=FPS, seed=8)
    return recorded.events, recorded.frames, recorded.frame_t_us


def calibrated(*arguments: object) -> int:
    return cli.main(["calibrate", *map(str, arguments)])


def test_a_recording_gives_a_camera_and_a_report(
    made: tuple[np.ndarray, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = written(tmp_path / "walk.npz", *made)
    out, report = tmp_path / "mine.yaml", tmp_path / "report"
    assert calibrated(recording, "--out", out, "--report", report, "--temperature", 40) == 0
    said, steps = capsys.readouterr()
    assert said.startswith("This recording can be used")
    assert "s: report\n" in steps
    for word in ("contrast_response.k1", "90 % interval", "correlated", "behave", f"{out} written"):
        assert word in said
    camera = Camera.load(out)
    assert (camera.name, camera.width, camera.height) == ("mine", 48, 36)
    assert camera.parameters.temperature_c == 40
    on, off = camera.parameters.comparator.theta_on, camera.parameters.comparator.theta_off
    assert on * off == pytest.approx(1, rel=1e-3)
    assert out.read_text().startswith("# Calibrated by `voltcam calibrate` (exact law) from walk.npz.")
    simulator = Simulator(48, 36, camera.parameters, seed=1)
    events = np.concatenate([simulator.advance(f, int(t)) for f, t in zip(made[1], made[2], strict=True)])
    assert len(events) == pytest.approx(len(made[0]), rel=0.15)
    page = (report / "report.html").read_text()
    assert page.count("<figure>") == 3
    assert "http" not in page.replace("http://www.w3.org", "")  # nothing is loaded


def test_the_papers_method(made: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    recording = written(tmp_path / "walk.npz", *made)
    out = tmp_path / "paper.yaml"
    assert calibrated(recording, "--out", out, "--method", "paper", "--report", tmp_path) == 0
    assert 1 < Camera.load(out).parameters.contrast_response.k1 < 20


def test_broken_recordings_give_a_verdict(
    made: tuple[np.ndarray, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    events, frames, t_us = made
    early = events[events["t"] < 1_000_000]
    away = events.copy()
    away["t"] += 10**9
    dark = np.full_like(frames, 3)
    broken = {
        "no frames": (events, frames[:0], t_us[:0]),
        "no events": (events[:0], frames, t_us),
        "different clocks": (away, frames, t_us),
        "too short": (early, frames[: FPS + 1], t_us[: FPS + 1]),
        "lens cap": (events[::50], dark, t_us),
    }
    for words, parts in broken.items():
        recording = written(tmp_path / f"{words.replace(' ', '-')}.npz", *parts)
        out = tmp_path / "never.yaml"
        assert calibrated(recording, "--out", out) == 1, words
        said = capsys.readouterr()
        assert words in said.err
        assert said.err.startswith("voltcam: ")
        assert said.err.count("\n") == 1
        assert not out.exists()


def test_wrong_arguments_are_told_before_the_work(
    made: tuple[np.ndarray, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = written(tmp_path / "walk.npz", *made)
    assert calibrated(recording, "--out", tmp_path / "no" / "mine.yaml") == 1
    assert "is not a folder" in capsys.readouterr().err
    assert calibrated(tmp_path / "none.npz", "--out", tmp_path / "mine.yaml") == 1
    assert capsys.readouterr().err.count("\n") == 1
    parser = ArgumentParser()
    cli_calibrate.configure(parser)
    with pytest.raises(SystemExit):
        parser.parse_args([str(recording), "--out", "mine.txt"])
    assert "ends in .yaml" in capsys.readouterr().err
    with pytest.raises(CalibrationError, match="346x260"):
        camera_from(inspect(load(recording)), base=Camera.load("davis346"))
