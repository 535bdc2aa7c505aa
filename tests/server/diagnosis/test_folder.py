"""Folders of diagnoses: what is in a new one, and what is left of an old one."""

import os
from pathlib import Path

import pytest

from voltcam_server.diagnosis.folder import FOLDER, GATHERED, REPORT, START, DiagnosisFolders
from voltcam_server.problems import UsageError
from voltcam_simulator import Camera

from ..rig import tiny

NO_PID = 2**22 + 1  # above the kernel's largest


def filled(folder: Path, report: bool = True) -> Path:
    """As a diagnosis leaves it: results, the recording it gathered, and its work."""
    folder.mkdir(exist_ok=True)
    (folder / "runs").mkdir()
    for name in (GATHERED, "result.json", "runs/1.npz", *([REPORT] if report else [])):
        (folder / name).write_text("x")
    return folder


def left(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_a_new_one_has_the_camera_it_begins_from(tmp_path: Path) -> None:
    camera = tiny(temperature_c=40)
    folders = DiagnosisFolders(tmp_path)
    first, second = folders.make(camera), folders.make(camera)
    assert first != second
    assert first.parent == second.parent == tmp_path
    assert left(first) == [START]
    assert Camera.load(first / START) == camera


def test_without_a_place_it_is_where_temporary_files_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert DiagnosisFolders(None).make(tiny()).parent == tmp_path


def test_no_place_is_said_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"^no folder for the diagnosis: .*none.*: set TMPDIR$"):
        DiagnosisFolders(tmp_path / "none").make(tiny())


def test_of_one_that_is_over_the_report_and_small_things_stay(tmp_path: Path) -> None:
    folders = DiagnosisFolders(tmp_path)
    done, broken = folders.make(tiny()), folders.make(tiny())
    filled(done)
    filled(broken, report=False)
    folders.tidy_up()
    assert left(done) == [REPORT, "result.json", START]
    assert not broken.exists()


def test_of_daemons_that_are_gone_too_and_of_no_one_else(tmp_path: Path) -> None:
    gone = filled(tmp_path / f"{FOLDER}{NO_PID}-aa-bb", report=False)
    gone_with_report = filled(tmp_path / f"{FOLDER}{NO_PID}-aa-cc")
    neighbour = filled(tmp_path / f"{FOLDER}{os.getppid()}-aa-bb", report=False)
    another_camera = DiagnosisFolders(tmp_path).make(tiny())
    filled(another_camera, report=False)
    other = filled(tmp_path / "holiday", report=False)
    DiagnosisFolders(tmp_path).tidy_up()
    assert not gone.exists()
    assert left(gone_with_report) == [REPORT, "result.json"]
    for kept in (neighbour, another_camera, other):
        assert (kept / GATHERED).exists()
