"""Label images beside frames: as indices, in the sensor's pixels, refused where they do not match."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.server.dataset.rig import HEIGHT, WIDTH, image_folder

from voltcam_server.dataset.labels import BesideError, check_labels, label_images, write_labels
from voltcam_video import fit, fit_labels


def test_labels_lie_where_the_frame_s_pixels_do() -> None:
    """Large enough areas of one grey are that grey in the frame, and that label in the labels."""
    areas = np.kron(np.arange(1, 7, dtype=np.uint8).reshape(2, 3), np.ones((30, 40), np.uint8))
    for how in ("crop", "letterbox", "stretch"):
        frame = fit(areas * np.uint8(40), 50, 40, how)
        labels = fit_labels(areas, 50, 40, how)
        assert labels.shape == (40, 50)
        assert set(np.unique(labels)) <= {0, 1, 2, 3, 4, 5, 6}
        assert np.mean(labels * 40 != frame) < 0.2, "but for the seams, which a frame has blurred"
        inside = (frame % 40 == 0) & (np.abs(labels.astype(int) * 40 - frame) >= 40)
        assert np.mean(inside) < 0.06


@pytest.mark.parametrize(("mode", "dtype"), [("L", np.uint8), ("P", np.uint8), ("I;16", np.uint16)])
def test_indices_are_kept_as_they_are(tmp_path: Path, mode: str, dtype: type) -> None:
    labels = np.arange(WIDTH * HEIGHT, dtype=dtype).reshape(HEIGHT, WIDTH) % 7
    image = Image.fromarray(labels)
    if mode == "P":
        image.putpalette([(37 * i) % 256 for i in range(768)])
    assert image.mode == mode
    image.save(tmp_path / "0.png")
    listed = [(tmp_path / "0.png", 100)]
    write_labels(tmp_path / "out.npz", listed, (WIDTH, HEIGHT), "crop")
    with np.load(tmp_path / "out.npz") as read:
        assert read["labels"].dtype == dtype
        assert np.array_equal(read["labels"][0], labels)
        assert read["t_us"].tolist() == [100]


def test_a_list_has_their_own_times(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "labels", 4)
    (folder / "images.txt").write_text("0 0.png\n0.01 1.png\n0.05 2.png\n")
    check_labels(folder, 100, (WIDTH, HEIGHT))
    at = label_images(folder).at([0, 20_000])
    assert [(path.name, t_us) for path, t_us in at] == [("0.png", 0), ("1.png", 10_000)]


def test_what_does_not_match_is_said_with_the_remedy(tmp_path: Path) -> None:
    folder = image_folder(tmp_path / "labels", 4)
    check_labels(folder, 4, (WIDTH, HEIGHT))
    with pytest.raises(BesideError, match="labels has 4 label images for 5 frames: give one for each"):
        check_labels(folder, 5, (WIDTH, HEIGHT))
    with pytest.raises(BesideError, match=r"0\.png has 24x16 pixels, its frame 48x32: give labels"):
        check_labels(folder, 4, (48, 32))
    with pytest.raises(BesideError, match=r"labels: .*gone"):
        check_labels(tmp_path / "gone", 4, (WIDTH, HEIGHT))
    Image.new("RGB", (WIDTH, HEIGHT)).save(folder / "0.png")
    with pytest.raises(BesideError, match="is a picture in RGB: give indices"):
        write_labels(tmp_path / "out.npz", [(folder / "0.png", 0)], (WIDTH, HEIGHT), "crop")
    (folder / "3.png").write_bytes(b"no image")
    with pytest.raises(BesideError, match=r"3\.png is not an image"):
        check_labels(folder, 4, (WIDTH, HEIGHT))
