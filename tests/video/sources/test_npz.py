from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_video import Frame, SourceError, SourceRequest, open_source

FRAMES = np.arange(3 * 4 * 5, dtype=np.uint8).reshape(3, 4, 5)
T_US = np.array([100, 250, 1_700_000_000_000_000])


def read_fast(path: Path) -> list[Frame]:
    with open_source(SourceRequest(uri=str(path), pace="fast")) as source:
        return list(source)


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_frames_and_times_come_back(tmp_path: Path, save: Any) -> None:
    path = tmp_path / "a.npz"
    save(path, frames=FRAMES, t_us=T_US, x=np.zeros(2))
    frames = read_fast(path)
    assert [frame.t_us for frame in frames] == T_US.tolist()
    assert np.array_equal([frame.image for frame in frames], FRAMES)


def test_floats_16_bits_and_rgb(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, frames=FRAMES + 0.25, t_us=T_US)
    np.testing.assert_allclose([frame.image for frame in read_fast(path)], FRAMES + 0.25)
    np.savez(path, frames=np.full((1, 2, 2), 514, np.uint16), t_us=T_US[:1])
    assert read_fast(path)[0].image.tolist() == [[2, 2], [2, 2]]
    np.savez(path, frames=np.full((1, 1, 1, 3), (255, 0, 0), np.uint8), t_us=T_US[:1])  # red
    assert read_fast(path)[0].image.tolist() == [[76]]


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"images": FRAMES, "t_us": T_US}, r"needs frames .* and t_us .* has images, t_us"),
        ({"frames": FRAMES[0], "t_us": T_US}, r"frames is \(4, 5\) uint8; it must be"),
        ({"frames": FRAMES.astype(np.int32), "t_us": T_US}, r"frames is \(3, 4, 5\) int32"),
        ({"frames": np.asfortranarray(FRAMES), "t_us": T_US}, r"Fortran order"),
        ({"frames": FRAMES[:0], "t_us": T_US[:0]}, r"not empty"),
        ({"frames": FRAMES, "t_us": T_US[:2]}, r"t_us is \(2,\) int64; it must be \(3,\)"),
        ({"frames": FRAMES, "t_us": T_US / 1e6}, r"t_us is \(3,\) float64"),
        ({"frames": FRAMES, "t_us": T_US[[0, 2, 1]]}, r"t_us\[2\] = 250 is not later than t_us\[1\]"),
        ({"frames": FRAMES, "t_us": T_US[[0, 0, 1]]}, r"t_us\[1\] = 100 is not later than t_us\[0\] = 100"),
        ({"frames": FRAMES, "t_us": np.array([None] * 3)}, r"damaged or no \.npz"),
    ],
)
def test_wrong_arrays_are_refused(tmp_path: Path, arrays: dict[str, Any], message: str) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, **arrays)
    with pytest.raises(SourceError, match=message) as error:
        open_source(SourceRequest(uri=str(path)))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("value", [-1, 256, np.nan, np.inf])
def test_floats_outside_the_range_are_named(tmp_path: Path, value: float) -> None:
    path = tmp_path / "a.npz"
    frames = FRAMES.astype(np.float64)
    frames[1, 2, 2] = value
    np.savez(path, frames=frames, t_us=T_US)
    with pytest.raises(SourceError, match=r"frames\[1\] has values outside 0\.\.255"):
        read_fast(path)


def test_damaged_and_missing_files(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    with pytest.raises(SourceError, match="no such file"):
        open_source(SourceRequest(uri=str(path)))
    path.write_bytes(b"no zip")
    with pytest.raises(SourceError, match=r"damaged or no \.npz"):
        open_source(SourceRequest(uri=str(path)))
    np.savez(path, frames=np.zeros((50, 40, 40), np.uint8), t_us=np.arange(50))
    content = bytearray(path.read_bytes())
    content[40_000] ^= 1
    path.write_bytes(content)
    with pytest.raises(SourceError, match=r"damaged: \d+ of 50 frames read"):
        read_fast(path)
