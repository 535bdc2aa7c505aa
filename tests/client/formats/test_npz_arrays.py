"""What an .npz says of its arrays, and these row by row, against np.load."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError
from voltcam_client.formats.npz_arrays import array_names, check_arrays, open_array, rows

FRAMES = np.arange(3 * 4 * 5, dtype=np.uint16).reshape(3, 4, 5)


def written(path: Path, **members: bytes) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(f"{name}.npy", content)
    return path


def saved(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def test_an_array_comes_row_by_row(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "a.npz", frames=FRAMES, t_us=np.arange(3))
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert array_names(archive) == ["frames", "t_us"]
        check_arrays(tmp_path / "a.npz", archive)
        with open_array(tmp_path / "a.npz", archive, "frames") as (header, file):
            assert (header.shape, header.fortran, header.dtype) == ((3, 4, 5), False, np.uint16)
            assert header.bytes == FRAMES.nbytes
            assert np.array_equal(list(rows(file, header)), FRAMES)


def test_rows_that_are_missing_are_no_rows(tmp_path: Path) -> None:
    path = written(tmp_path / "a.npz", frames=saved(FRAMES)[:-1])
    with (
        zipfile.ZipFile(path) as archive,
        open_array(path, archive, "frames") as (header, file),
        pytest.raises(ValueError, match="buffer size"),
    ):
        list(rows(file, header))


def test_an_array_that_is_smaller_than_it_says_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "a.npz", a=saved(np.arange(3)), b=saved(np.arange(300))[:200])
    with zipfile.ZipFile(path) as archive:
        check_arrays(path, archive, ["a"])
        with pytest.raises(FormatError, match="cut short or damaged"):
            check_arrays(path, archive)


def test_more_than_such_a_file_may_hold_is_refused(tmp_path: Path) -> None:
    """100 MB of zeros in a file of 100 kB."""
    np.savez_compressed(tmp_path / "a.npz", a=np.zeros(100_000_000, np.uint8))
    with (
        zipfile.ZipFile(tmp_path / "a.npz") as archive,
        pytest.raises(FormatError, match="more than it can"),
    ):
        check_arrays(tmp_path / "a.npz", archive)


def test_a_version_that_is_not_known_is_named(tmp_path: Path) -> None:
    content = bytearray(saved(FRAMES))
    content[6] = 9
    path = written(tmp_path / "a.npz", frames=bytes(content))
    with zipfile.ZipFile(path) as archive, pytest.raises(FormatError, match=r"frames\.npy has a version"):
        check_arrays(path, archive)
