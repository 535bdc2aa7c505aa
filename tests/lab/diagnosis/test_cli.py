"""`voltcam diagnose`, from end to end."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError
from voltcam_lab.diagnosis import cli as cli_diagnose
from voltcam_lab.diagnosis.outcome.accepted import accepted, fitted
from voltcam_lab.diagnosis.outcome.conclude import result_of
from voltcam_lab.diagnosis.outcome.result import Result
from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.session import DiagnosisError
from voltcam_lab.statistics import Values
from voltcam_simulator import Camera, Parameters

from .conftest import FEW_ENTRIES, FEW_RUNS, Done


def diagnose(*arguments: object) -> int:
    parser = argparse.ArgumentParser()
    cli_diagnose.configure(parser)
    parsed = parser.parse_args([str(one) for one in arguments])
    return int(parsed.run(parsed, FEW_RUNS, FEW_ENTRIES))


def test_interrupted_and_resumed_it_gives_the_same_result(
    done: Done,
    tiny_path: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cli_diagnose, "cores", lambda: 1)  # so that the runs can be counted here
    simulate, simulated = Rig.run, list[tuple[object, ...]]()

    def interrupted(rig: Rig, parameters: Parameters, seeds: Sequence[int], *how: bool) -> Values:
        simulated.append((*seeds, *how, parameters.model_dump_json()))
        if len(simulated) == 60:
            raise KeyboardInterrupt
        return simulate(rig, parameters, seeds, *how)

    out = tmp_path / "out"
    monkeypatch.setattr(Rig, "run", interrupted)
    assert diagnose(tiny_path, "--camera", "paper", "--out", out) == 130
    assert "goes on from there" in capsys.readouterr().err
    kept = len(list((out / ".voltcam-runs").glob("*.npy")))
    assert kept >= 50
    assert not (out / "result.json").exists()

    assert diagnose(tiny_path, "--camera", "paper", "--out", out) == 0
    assert not (out / ".voltcam-runs").exists()
    said = capsys.readouterr().out
    result = Result.model_validate_json((out / "result.json").read_text())
    choice = accepted(
        done.session.sensor, done.session.parameters, fitted(done.diagnosis), True, lambda _: None
    )
    straight = result_of(done.session, done.search, done.identifiability, done.diagnosis, file=choice)
    assert result == straight
    assert len(simulated) > 100
    assert len(simulated) - len(set(simulated)) <= 3, "what was done before the interruption is done again"
    for words in ("What this recording can tell", done.sentences[-1], result.sentence, "report.html written"):
        assert words in said
    assert (
        said.index("What this recording can tell")
        < said.index(done.sentences[0])
        < said.index(result.sentence)
    )
    assert result.sentence.split(".")[0] in (out / "report.html").read_text()
    assert Camera.load(out / "camera.yaml").parameters.refractory_period.period_us > 4000
    assert json.loads((out / "result.json").read_text())["verdict"] == "effects"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--camera", "nikon"), "unknown camera"),
        (("--camera", "paper", "--seconds", "0.01"), "fewer than 10 frames"),
    ],
)
def test_mistakes_are_told_in_a_line_and_leave_nothing(
    tiny_path: Path, tmp_path: Path, arguments: tuple[str, ...], words: str
) -> None:
    with pytest.raises(ValueError, match=words) as caught:
        diagnose(tiny_path, *arguments, "--out", tmp_path / "out")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_a_file_is_no_folder_for_results(tiny_path: Path, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    with pytest.raises(DiagnosisError, match="is a file"):
        diagnose(tiny_path, "--camera", "paper", "--out", tmp_path / "out")
    assert (tmp_path / "out").read_text() == "mine"


def test_a_broken_recording_is_told_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "broken.npz").write_bytes(b"PK\x03\x04 and no more")
    with pytest.raises((FormatError, OSError)) as caught:
        diagnose(tmp_path / "broken.npz", "--camera", "paper", "--out", tmp_path / "out")
    assert "\n" not in str(caught.value)
    np.savez(tmp_path / "none.npz", t=[0], x=[0], y=[0], p=[True], width=4, height=4)
    with pytest.raises(ValueError, match="frames"):
        diagnose(tmp_path / "none.npz", "--camera", "paper", "--out", tmp_path / "out")


@pytest.mark.parametrize("wrong", [("--seed", "-1"), ("--seconds", "0"), ("--seconds", "x")])
def test_numbers_out_of_range_are_refused(
    tiny_path: Path, tmp_path: Path, wrong: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        diagnose(tiny_path, "--camera", "paper", "--out", tmp_path / "out", *wrong)
    assert caught.value.code == 2
    assert wrong[0] in capsys.readouterr().err
