from pathlib import Path

import cv2
import numpy as np
import pytest

from voltcam_video.photos import PhotoFolder, UnreadablePhotographError


def test_photographs_come_by_name_and_as_they_are(tmp_path: Path) -> None:
    for i, name in enumerate(["b.png", "a.PNG", "c.tiff"]):
        cv2.imwrite(str(tmp_path / name), np.full((4, 5, 3), 10 * i, np.uint8))
    cv2.imwrite(str(tmp_path / "d.png"), np.full((2, 2), 40_000, np.uint16))
    (tmp_path / "read.me").touch()
    photographs = PhotoFolder(tmp_path)
    assert [path.name for path in photographs.paths] == ["a.PNG", "b.png", "c.tiff", "d.png"]
    assert [image.flat[0] for image in photographs] == [10, 0, 20, 40_000]
    assert [image.shape for image in photographs[1:]] == [(4, 5, 3), (4, 5, 3), (2, 2)]


@pytest.mark.parametrize("content", [b"", b"no picture", b"\x89PNG\r\n\x1a\n"])
def test_a_damaged_one_is_named_when_it_is_looked_at(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.png").write_bytes(content)
    photographs = PhotoFolder(tmp_path)
    with pytest.raises(UnreadablePhotographError, match=r"a\.png: no photograph OpenCV can read"):
        photographs[0]


def test_a_folder_without_any_or_that_is_none_says_so(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no photograph in this folder"):
        PhotoFolder(tmp_path)
    with pytest.raises(ValueError, match="no such folder"):
        PhotoFolder(tmp_path / "none")
