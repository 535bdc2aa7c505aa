"""What grey levels are, by kind of source and by word."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from voltcam_video import VIDEO_GAMMA, SourceRequest, open_source
from voltcam_video.light import Levels

GREY = np.full((8, 8), 100, np.uint8)


def source_at(folder: Path, kind: str) -> str:
    """A source of that kind, of two frames."""
    if kind == "scene":
        return "scene"
    if kind == "npz":
        np.savez(folder / "a.npz", frames=np.stack([GREY, GREY]), t_us=np.array([0, 1000]))
        return str(folder / "a.npz")
    if kind == "video":
        writer = cv2.VideoWriter(str(folder / "a.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 30, (16, 16))
        for _ in range(2):
            writer.write(np.zeros((16, 16, 3), np.uint8))
        writer.release()
        return str(folder / "a.avi")
    cv2.imwrite(str(folder / "0.png"), GREY)
    (folder / "images.txt").write_text("0.0 0.png\n")
    if kind == "recording":
        (folder / "events.txt").write_text("0.0 1 1 1\n")
    return str(folder)


@pytest.mark.parametrize(
    ("kind", "levels", "gamma"),
    [
        ("scene", "auto", 1.0),
        ("npz", "auto", 1.0),
        ("recording", "auto", 1.0),
        ("images", "auto", VIDEO_GAMMA),
        ("video", "auto", VIDEO_GAMMA),
        ("video", "light", 1.0),
        ("npz", "video", VIDEO_GAMMA),
        ("scene", "video", VIDEO_GAMMA),
    ],
)
def test_each_frame_says_what_its_grey_levels_are(
    kind: str, levels: Levels, gamma: float, tmp_path: Path
) -> None:
    request = SourceRequest(uri=source_at(tmp_path, kind), levels=levels, pace="fast")
    with open_source(request) as source:
        frame = source.read()
        assert source.granted["levels"] == ("light" if gamma == 1 else "video")
    assert frame is not None
    assert frame.gamma == gamma
