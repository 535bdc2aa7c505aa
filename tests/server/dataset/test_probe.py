"""Inputs looked at beforehand: one line for each that will not do."""

from pathlib import Path
from typing import Any

import cv2
import pytest
from PIL import Image
from tests.server.dataset.rig import FRAMES, HEIGHT, WIDTH, clip, image_folder, images, spec

from voltcam_server.dataset.clips import clips_of
from voltcam_server.dataset.probe import Probed, probed


def look(folder: Path, seconds: float | None = None, **given: Any) -> Probed:
    [one] = probed(clips_of(spec(folder, {"files": f"{folder}/in/*"} | given)), seconds)
    assert "\n" not in one.problem
    return one


def test_a_good_one_says_its_frames(tmp_path: Path) -> None:
    clip(tmp_path / "in" / "one.npz")
    assert (look(tmp_path).frames, look(tmp_path).problem) == (FRAMES, "")
    assert look(tmp_path, seconds=0.02).frames == 3


def test_one_frame_is_too_few(tmp_path: Path) -> None:
    clip(tmp_path / "in" / "one.npz", count=1)
    assert "one.npz has one frame: events need two, give a longer one" in look(tmp_path).problem


def test_images_of_several_sizes_are_told_apart(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "in" / "walk", 3)
    assert look(tmp_path, fps=10).problem == ""
    Image.new("L", (32, 8)).save(folder / "1.png")
    assert look(tmp_path, fps=10).problem.endswith("1.png has 32x8 pixels, 0.png 24x16: make all of one size")


@pytest.mark.parametrize("count", [FRAMES - 1, FRAMES + 1])
def test_labels_that_do_not_match_are_told(tmp_path: Path, count: int) -> None:
    clip(tmp_path / "in" / "one.npz")
    image_folder(tmp_path / "labels" / "one", count)
    labels = f"{tmp_path}/labels/{{stem}}"
    assert (
        f"has {count} label images for 6 frames: give one for each" in look(tmp_path, labels=labels).problem
    )


def test_a_video_s_frames_are_counted_where_labels_are_for_another_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "in").mkdir()
    video = cv2.VideoWriter(
        str(tmp_path / "in" / "one.mp4"), cv2.VideoWriter.fourcc(*"mp4v"), 30, (WIDTH, HEIGHT)
    )
    for image in images():
        video.write(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR))
    video.release()
    image_folder(tmp_path / "labels" / "one", FRAMES)
    labels = f"{tmp_path}/labels/{{stem}}"
    assert look(tmp_path, labels=labels).problem == ""
    real = cv2.VideoCapture

    class Announcing:
        """Two frames more than there are."""

        def __init__(self, *arguments: Any) -> None:
            self._capture = real(*arguments)

        def __getattr__(self, name: str) -> Any:
            return getattr(self._capture, name)

        def get(self, prop: int) -> float:
            return 8.0 if prop == cv2.CAP_PROP_FRAME_COUNT else self._capture.get(prop)

    monkeypatch.setattr(cv2, "VideoCapture", Announcing)
    assert look(tmp_path).frames == 8
    assert look(tmp_path, labels=labels).problem == "", "6 were there, whatever is announced"


def test_what_is_unreadable_is_told(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "one.mp4").write_bytes(b"no video")
    assert "one.mp4: not a video ffmpeg can read" in look(tmp_path).problem
    (tmp_path / "in" / "one.mp4").unlink()
    clip(tmp_path / "in" / "one.npz")
    assert "cannot be read as CSV" in look(tmp_path, table=f"{tmp_path}/gone.csv").problem
