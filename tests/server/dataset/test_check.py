"""A set held against its manifest."""

from pathlib import Path

import pytest
from tests.server.dataset.rig import clip, clips, made, spec

from voltcam_server.dataset.check import check_set
from voltcam_server.problems import UsageError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    inputs = clips(tmp_path / "in", 3)
    clip(inputs / "short.npz", count=1)
    made(spec(tmp_path, f"{inputs}/*"), tmp_path / "set")
    return tmp_path / "set"


def test_a_whole_set_is_whole(folder: Path) -> None:
    found = check_set(folder)
    assert found.faults == ()
    assert found.words == (
        f"{folder}: 3 items in 3 files, all as they were made; 1 inputs gave no item, as the manifest says"
    )


def test_each_fault_is_a_line_with_its_remedy(folder: Path) -> None:
    items = folder / "items"
    changed = bytearray((items / "clip0.npz.0.h5").read_bytes())
    changed[-1] ^= 1
    (items / "clip0.npz.0.h5").write_bytes(changed)
    (items / "clip1.npz.0.h5").unlink()
    (items / "mine.txt").write_text("notes")
    found = check_set(folder)
    assert found.faults == (
        "items/clip0.npz.0.h5: not as it was made: remove it and make the set again",
        "items/clip1.npz.0.h5: No such file or directory: make the set again, which makes what is not there",
        "items/mine.txt: not in the manifest: remove it, or make the set to its end",
    )
    assert "3 faults" in found.words


def test_what_the_remedies_say_helps(tmp_path: Path, folder: Path) -> None:
    (folder / "items" / "clip0.npz.0.h5").unlink()
    made(spec(tmp_path, f"{tmp_path}/in/*"), folder)
    assert check_set(folder).faults == ()


def test_what_is_no_set_is_said(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"is no data set: it has no manifest\.jsonl"):
        check_set(tmp_path)
    for text in ("no json\n", "[]\n", '{"name": "a"}\n', '{"name": "a", "variant": "x"}\n'):
        (tmp_path / "manifest.jsonl").write_text(text)
        with pytest.raises(UsageError, match=r"manifest\.jsonl, line 1 is no item's"):
            check_set(tmp_path)
