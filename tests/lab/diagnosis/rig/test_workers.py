"""Processes that run a rig: the same numbers, and nothing of them is left behind."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from multiprocessing import active_children
from pathlib import Path

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.rig.stored import StoredRig
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.loop import diagnose
from voltcam_lab.diagnosis.search.state import search_of
from voltcam_lab.diagnosis.session import session_of
from voltcam_lab.health import inspect
from voltcam_lab.light.scene import scene_of
from voltcam_lab.recordings import Footage
from voltcam_lab.statistics import setting_of
from voltcam_simulator import Camera, Parameters

from ..conftest import FEW_ENTRIES, FEW_RUNS, Done

PAPER = Parameters.of("paper")
MANY = [PAPER, PAPER.changed({"photon_noise": {"k3": 1e-3}})]
OUTLIVED = """
import sys, time
from multiprocessing import active_children
from pathlib import Path
from tests.lab.diagnosis.rig.test_workers import PAPER, rig
rig(Path(sys.argv[1])).runs([PAPER], range(8))
print(*(child.pid for child in active_children()), flush=True)
time.sleep(60)
"""


def rig(folder: Path, processes: int = 2) -> StoredRig:
    t_us = np.arange(0, 500_001, 10_000)
    phase = t_us[:, None, None] * 4e-6 + np.arange(16) * 0.15 + np.arange(12)[:, None] * 0.1
    frames = (100 + 80 * np.sin(2 * np.pi * phase)).astype(np.float32)
    setting = setting_of(scene_of(frames, t_us, "cubic"), t_us, parameters=PAPER)
    return StoredRig(setting, folder, processes=processes)


def test_they_see_what_one_process_sees(tmp_path: Path) -> None:
    two = rig(tmp_path / "two")
    one = Rig(two.setting)
    for theirs, own in zip(two.runs(MANY, range(6)), one.runs(MANY, range(6)), strict=True):
        np.testing.assert_array_equal(theirs, own)
    two.forget()
    assert not active_children()
    assert not (tmp_path / "two").exists()


def test_a_diagnosis_with_them_is_the_same(done: Done, tiny: Footage, tmp_path: Path) -> None:
    """Trials are fitted side by side then."""
    session = session_of(inspect(tiny), Camera.load("paper"), tmp_path, processes=3, entries=FEW_ENTRIES)
    diagnosis = diagnose(search_of(session, FEW_RUNS), Hypothesis(session.parameters))
    session.rig.end()
    assert diagnosis.hypothesis.parameters() == done.diagnosis.hypothesis.parameters()
    assert [step.training for step in diagnosis.steps] == [step.training for step in done.diagnosis.steps]
    assert [one.effect for one in diagnosis.found] == ["refractory_period"]


def test_what_is_wrong_with_one_ends_what_the_others_have_begun(tmp_path: Path) -> None:
    two, ran = rig(tmp_path), list[int]()

    def fit(item: int) -> None:
        for seed in range(4 * item, 4 * item + 400, 4):
            two.run(PAPER, [seed])
            ran.append(seed)
            if item:
                raise ValueError("this one")

    with pytest.raises(ValueError, match="this one"):
        two.each(fit, [0, 1000])
    assert 1 <= len(ran) < 100
    with pytest.raises(CancelledError):
        two.run(PAPER, [1])


def test_one_that_is_killed_ends_the_diagnosis_with_the_remedy(tmp_path: Path) -> None:
    two = rig(tmp_path)
    two.runs([PAPER], range(8))
    for child in active_children():
        child.kill()
    with pytest.raises(OSError, match="look at less"):
        two.runs([MANY[1]], range(8))
    assert len(list(tmp_path.glob("*.npy"))) == 2, "what was done is kept"


def test_they_do_not_outlive_a_process_that_is_killed(tmp_path: Path) -> None:
    parent = subprocess.Popen(
        [sys.executable, "-c", OUTLIVED, str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        encoding="utf-8",
    )
    with parent:
        assert parent.stdout is not None
        workers = [int(pid) for pid in parent.stdout.readline().split()]
        assert workers
        assert all(_runs(pid) for pid in workers)
        parent.send_signal(signal.SIGKILL)
        end_s = time.monotonic() + 30
        while any(_runs(pid) for pid in workers) and time.monotonic() < end_s:
            time.sleep(0.05)
        assert not any(_runs(pid) for pid in workers)


def _runs(pid: int) -> bool:
    """A process that has ended may wait for a parent that never asks: it is called a zombie then."""
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False
