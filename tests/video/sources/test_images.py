import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from voltcam_video import Frame, SourceError, SourceRequest, open_source

ROOT = Path(__file__).resolve().parents[3]
DATA = Path(os.environ.get("VOLTCAM_DATA", ROOT / "../shared/data"))


def read_fast(folder: Path) -> list[Frame]:
    with open_source(SourceRequest(uri=str(folder), pace="fast")) as source:
        return list(source)


def write(folder: Path, listing: str, names: tuple[str, ...] = ("a.png", "b.png", "c.png")) -> Path:
    for i, name in enumerate(names):
        cv2.imwrite(str(folder / name), np.full((4, 6), 50 * i, np.uint8))
    (folder / "images.txt").write_text(listing)
    return folder


def test_images_come_at_the_listed_times(tmp_path: Path) -> None:
    frames = read_fast(write(tmp_path, "# seconds file\n0.5 b.png\n\n0.75 a.png\n1e0 c.png\n"))
    assert [frame.t_us for frame in frames] == [500_000, 750_000, 1_000_000]
    assert [int(frame.image[0, 0]) for frame in frames] == [50, 0, 100]


def test_epoch_seconds_keep_their_microseconds(tmp_path: Path) -> None:
    frames = read_fast(write(tmp_path, "1468939993.067416019 a.png\n1468939993.067417019 b.png\n"))
    assert [frame.t_us for frame in frames] == [1_468_939_993_067_416, 1_468_939_993_067_417]


def test_names_may_have_spaces_and_folders(tmp_path: Path) -> None:
    (tmp_path / "my images").mkdir()
    frames = read_fast(write(tmp_path, "0 my images/first one.png\n", ("my images/first one.png",)))
    assert len(frames) == 1


def test_image_sizes_may_differ(tmp_path: Path) -> None:
    write(tmp_path, "0 a.png\n1 b.png\n")
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((7, 3, 3), np.uint8))
    assert [frame.image.shape for frame in read_fast(tmp_path)] == [(4, 6), (7, 3)]


def test_16_bit_images_keep_their_depth(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.full((4, 6), 300, np.uint16))
    (tmp_path / "images.txt").write_text("0 a.png\n")
    image = read_fast(tmp_path)[0].image
    assert image.dtype == np.float32
    np.testing.assert_allclose(image, 300 / 257, rtol=1e-6)


def test_real_recording() -> None:
    folder = DATA / "slider_depth"
    if not folder.is_dir():
        pytest.skip("needs the slider_depth recording in ../shared/data or $VOLTCAM_DATA")
    with open_source(SourceRequest(uri=str(folder), pace="fast")) as source:
        assert (source.granted["width"], source.granted["height"], source.granted["frames"]) == (240, 180, 87)
        assert source.granted["fps"] == pytest.approx(25.8, abs=0.1)
        frames = list(source)
    assert [frame.t_us for frame in frames[:3]] == [0, 38_766, 77_531]
    assert len(frames) == 87
    assert all(frame.image.shape == (180, 240) and frame.image.dtype == np.uint8 for frame in frames)


@pytest.mark.parametrize(
    ("listing", "message"),
    [
        (
            "0 a.png\n0.1 b.png\n0.1 c.png\n",
            r"line 3: 100000 us is not later than .* \(100000 us\)",
        ),
        ("0 a.png\n0.2 b.png\n0.1 c.png\n", r"line 3: 100000 us is not later"),
        ("0 a.png\nb.png\n", r"line 2: not 'seconds filename'"),
        ("nan a.png\n", r"line 1: not 'seconds filename'"),
        ("0 a.png\n1 d.png\n", r"line 2: no such image"),
        ("0 a.png\n1\n", r"line 2: not 'seconds filename'"),
        ("\n# nothing\n", r"lists no image"),
    ],
)
def test_a_wrong_list_is_refused_with_its_line(tmp_path: Path, listing: str, message: str) -> None:
    with pytest.raises(SourceError, match=message):
        open_source(SourceRequest(uri=str(write(tmp_path, listing))))


def test_a_folder_without_times_says_what_it_needs(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((4, 6), np.uint8))
    with pytest.raises(SourceError, match=r"no images\.txt in this folder; images need their times"):
        open_source(SourceRequest(uri=str(tmp_path)))


def test_a_damaged_image_is_named(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, "0 a.png\n1 b.png\n")
    (tmp_path / "b.png").write_bytes(b"no image")
    with (
        open_source(SourceRequest(uri=str(tmp_path), pace="fast")) as source,
        pytest.raises(SourceError, match=r"b\.png: not an image OpenCV can read"),
    ):
        list(source)
    assert capfd.readouterr() == ("", "")
