"""Recordings with their frames in memory."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError, Recording, open_writer
from voltcam_lab.recordings import load, with_frames

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[3] / "shared" / "data"))


def folder_of(folder: Path, images: list[np.ndarray]) -> Path:
    """An Event Camera Dataset folder."""
    folder.mkdir()
    (folder / "events.txt").write_text("0.000010 1 2 1\n0.050000 3 1 0\n")
    lines = []
    for i, image in enumerate(images):
        cv2.imwrite(str(folder / f"{i}.png"), image)
        lines.append(f"{0.04 * i:.6f} {i}.png\n")
    (folder / "images.txt").write_text("".join(lines))
    return folder


def test_a_folders_images_are_decoded_to_luminance(tmp_path: Path) -> None:
    grey = np.arange(12, dtype=np.uint8).reshape(3, 4)
    red = np.zeros((3, 4, 3), np.uint8)
    red[..., 2] = 200
    recording = load(folder_of(tmp_path / "folder", [grey, red]))
    np.testing.assert_array_equal(recording.frames[0], grey)
    assert set(recording.frames[1].ravel()) == {60}  # 0.299 * 200
    assert recording.frame_t_us.tolist() == [0, 40_000]
    assert (recording.width, recording.height) == (4, 3)
    assert recording.exposure_us is None


def test_other_formats_come_as_they_are(tmp_path: Path) -> None:
    events = np.array([(5, 1, 2, True)], EVENT)
    with open_writer(tmp_path / "a.npz", width=4, height=3) as writer:
        writer.events(events)
        writer.frame(np.full((3, 4), 9, np.uint8), 7)
    recording = load(tmp_path / "a.npz")
    np.testing.assert_array_equal(recording.events, events)
    assert recording.frames.tolist() == [[[9] * 4] * 3]


def test_one_without_frames_is_refused(tmp_path: Path) -> None:
    events = np.array([(5, 1, 2, True)], EVENT)
    with open_writer(tmp_path / "a.npz", width=4, height=3) as writer:
        writer.events(events)
    with pytest.raises(FormatError, match=r"a\.npz: no frames: record frames and events") as error:
        load(tmp_path / "a.npz")
    assert "\n" not in str(error.value)
    empty = Recording(events, 4, 3, np.zeros((0, 3, 4), np.uint8), np.zeros(0, np.int64))
    with pytest.raises(FormatError, match="the recording: no frames"):
        with_frames(empty)


def test_a_fault_is_one_line(tmp_path: Path) -> None:
    images = [np.zeros((3, 4), np.uint8), np.zeros((4, 4), np.uint8)]
    with pytest.raises(FormatError, match="2 sizes: give images of one size"):
        load(folder_of(tmp_path / "sizes", images))
    folder = folder_of(tmp_path / "none", images[:1])
    (folder / "0.png").write_bytes(b"no image")
    with pytest.raises(FormatError, match=r"0\.png: not an image OpenCV can read") as error:
        load(folder)
    assert "\n" not in str(error.value)


def test_the_slider() -> None:
    if not (DATA / "slider_depth").is_dir():
        pytest.skip("no slider_depth in ../shared/data or $VOLTCAM_DATA")
    recording = load(DATA / "slider_depth")
    assert recording.frames.shape == (87, 180, 240)
    assert (recording.events.size, recording.exposure_us) == (1_078_541, None)
