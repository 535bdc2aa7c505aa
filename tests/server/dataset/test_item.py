"""One item: what goes wrong with it is in its outcome, and nothing of it lies about."""

import errno
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.server.dataset.rig import clip, image_folder, spec

from voltcam_server.dataset import item as item_module
from voltcam_server.dataset.clips import Item, clips_of, items_of
from voltcam_server.dataset.item import ItemOutcome, Making, as_u8, camera_of, make_item


def one(folder: Path, pattern: str, **given: Any) -> tuple[Item, Making]:
    wanted = spec(folder, {"files": pattern, **given})
    [item] = items_of(wanted, clips_of(wanted))
    return item, Making(folder / "set", wanted.cameras(), "exact", "cpu", "cubic", "crop", None, True)


def made(item: Item, making: Making) -> ItemOutcome:
    outcome = make_item(item, making)
    assert not any((making.out / ".aside").iterdir()), "nothing lies aside"
    assert (making.out / item.path).exists() == (outcome.failed is None)
    return outcome


def test_a_size_that_changes_on_the_way_is_said(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "in" / "walk", 4)
    Image.new("L", (32, 8)).save(folder / "2.png")
    outcome = made(*one(tmp_path, f"{tmp_path}/in/*", fps=100))
    assert outcome.failed == "frame 2 has 32x8 pixels, those before 24x16: make all of one size"


def test_labels_that_turn_out_too_few_are_said(tmp_path: Path) -> None:
    image_folder(tmp_path / "in" / "walk", 4)
    image_folder(tmp_path / "labels", 3)
    outcome = made(*one(tmp_path, f"{tmp_path}/in/*", fps=100, labels=f"{tmp_path}/labels"))
    assert "has 3 label images for 4 frames" in str(outcome.failed)


@pytest.mark.parametrize(
    ("error", "failed", "full"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), "No space left", True),
        (OSError(errno.EDQUOT, "Disk quota exceeded"), "quota", True),
        (OSError(errno.EIO, "Input/output error"), "Input/output error", False),
        (MemoryError(), "not memory enough: give fewer --workers", False),
        (ValueError("of\nno use"), "of no use", False),
    ],
)
def test_an_error_is_an_outcome(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, failed: str, full: bool
) -> None:
    clip(tmp_path / "in" / "a.npz")

    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(item_module, "_written", fail)
    outcome = made(*one(tmp_path, f"{tmp_path}/in/*"))
    assert failed in str(outcome.failed)
    assert outcome.full == full


def test_a_camera_is_drawn_from_the_item_s_seed(tmp_path: Path) -> None:
    clip(tmp_path / "in" / "a.npz")
    drawn = {"comparator": {"theta_on": {"uniform": [0.5, 2]}}}
    wanted = spec(tmp_path, f"{tmp_path}/in/*", parameters=drawn, variants=3)
    items = items_of(wanted, clips_of(wanted))
    cameras = [camera_of(item, wanted.cameras()) for item in items]
    assert cameras == [camera_of(item, wanted.cameras()) for item in items]
    assert len({camera.parameters.comparator.theta_on for camera in cameras}) == 3


def test_frames_are_kept_in_8_bits() -> None:
    image = np.array([[-3, 0.4, 0.6, 300]], np.float32)
    assert as_u8(image).tolist() == [[0, 0, 1, 255]]
