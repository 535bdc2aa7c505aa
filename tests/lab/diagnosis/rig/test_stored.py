"""Runs that are kept on disk."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.rig.settings import LightError, RigSettings
from voltcam_lab.diagnosis.rig.stored import StoredRig
from voltcam_lab.diagnosis.session import session_of
from voltcam_lab.health import inspect
from voltcam_lab.recordings import Footage
from voltcam_simulator import Camera, Parameters

PAPER = Camera.load("paper")
SEEDS = [1, 2]


def test_runs_are_kept_and_a_broken_one_is_made_anew(
    tiny: Footage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = session_of(inspect(tiny), PAPER, tmp_path / "runs")
    parameters, made = Parameters.of("paper"), list[int]()
    simulate = Rig.events

    def counted(rig: Rig, parameters: Parameters, seeds: list[int], *how: bool) -> object:
        made.extend(seeds)
        return simulate(rig, parameters, seeds, *how)

    monkeypatch.setattr(Rig, "events", counted)
    first = session.rig.run(parameters, SEEDS)
    np.testing.assert_array_equal(session.rig.run(parameters, SEEDS), first)
    again = StoredRig(session.rig.setting, tmp_path / "runs")
    np.testing.assert_array_equal(again.run(parameters, SEEDS), first)
    assert len(made) == 2
    (kept,) = (tmp_path / "runs").glob("*.npy")
    kept.write_bytes(kept.read_bytes()[:100])
    np.testing.assert_array_equal(session.rig.run(parameters, SEEDS), first)
    assert len(made) == 4
    assert (StoredRig(session.rig.setting, tmp_path / "runs", seed=1).run(parameters, SEEDS) != first).any()
    other = RigSettings(on_curves=LightError(0.4, 0.24))
    bent = StoredRig(session.rig.setting, tmp_path / "runs", settings=other).run(parameters, SEEDS)
    assert (bent != first).any()
    session.rig.run(parameters.changed({"comparator": {"theta_on": 1.1}}), SEEDS)
    assert len(made) == 10
    session.rig.run(parameters, SEEDS, apart=True)
    assert len(made) == 12
    assert (session.rig.run(parameters, SEEDS, noisier=True) != first).any()
    assert len(made) == 14
    (tmp_path / "runs" / "diary.txt").touch()
    session.rig.forget()
    assert [path.name for path in (tmp_path / "runs").iterdir()] == ["diary.txt"]


def test_progress_tells_of_each_batch_and_run(tiny: Footage, tmp_path: Path) -> None:
    session = session_of(inspect(tiny), PAPER, tmp_path)
    batches, ended = list[int](), list[int]()
    session.rig.batch, session.rig.done = batches.append, ended.append
    session.rig.means([PAPER.parameters], range(3))
    session.rig.means([PAPER.parameters], range(3))  # remembered
    assert batches == [3, 3]
    assert sum(ended) == 6
