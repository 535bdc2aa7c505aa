"""`.npz` against numpy's own reader and writer."""

import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.formats import FormatError, open_writer, read
from voltcam_client.packet import EVENT

GOOD: dict[str, Any] = {
    "t": np.array([0, 5, 5], np.int64),
    "x": np.array([3, 2, 1], np.uint16),
    "y": np.array([0, 0, 7], np.uint16),
    "p": np.array([True, False, True]),
}


def test_numpy_loads_it(tmp_path: Path, make_events) -> None:
    events = make_events(1000, start_us=1_700_000_000_000_000)
    with open_writer(tmp_path / "a.npz", width=346, height=260) as writer:
        writer.events(events)
    with np.load(tmp_path / "a.npz") as arrays:
        assert set(arrays) == {"t", "x", "y", "p", "width", "height"}
        assert (arrays["width"], arrays["height"]) == (346, 260)
        for name in "txyp":
            np.testing.assert_array_equal(arrays[name], events[name], strict=True)
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert archive.testzip() is None
        assert {member.compress_type for member in archive.infolist()} == {zipfile.ZIP_STORED}


def test_numpy_loads_its_frames(tmp_path: Path, make_events) -> None:
    frames = np.random.default_rng(3).integers(0, 256, (5, 260, 346), np.uint8)
    times = 1_700_000_000_000_000 + 40_000 * np.arange(5)
    with open_writer(tmp_path / "a.npz", width=346, height=260) as writer:
        for frame, t_us in zip(frames, times, strict=True):
            writer.frame(frame, int(t_us))
    with np.load(tmp_path / "a.npz") as arrays:
        assert set(arrays) == {"t", "x", "y", "p", "width", "height", "frames", "t_us"}
        np.testing.assert_array_equal(arrays["frames"], frames, strict=True)
        np.testing.assert_array_equal(arrays["t_us"], times, strict=True)
    recording = read(tmp_path / "a.npz")
    np.testing.assert_array_equal(recording.frames, frames)
    np.testing.assert_array_equal(recording.frame_t_us, times)


def test_exposures_come_back(tmp_path: Path) -> None:
    images = np.random.default_rng(3).integers(0, 256, (3, 4, 6), np.uint8)
    writer = open_writer(tmp_path / "a.npz", width=6, height=4)
    for i, image in enumerate(images):
        writer.aps_frame(image, (1000 * i, 1000 * i + 501), (1000 * i - 9, 1000 * i + 900))
    exposures = [[1000 * i, 1000 * i + 501] for i in range(3)]
    assert read(tmp_path / "a.npz.partial").exposure_us.tolist() == exposures  # type: ignore[union-attr]
    writer.close()
    recording = read(tmp_path / "a.npz")
    assert recording.exposure_us is not None
    assert recording.frame_t_us is not None
    assert recording.exposure_us.tolist() == exposures
    assert recording.frame_t_us.tolist() == [1000 * i + 250 for i in range(3)]
    np.testing.assert_array_equal(recording.frames, images)


def test_exposures_of_another_shape_are_refused(tmp_path: Path) -> None:
    frames = {"frames": np.zeros((2, 4, 6), np.uint8), "t_us": np.array([0, 1])}
    np.savez(tmp_path / "a.npz", **GOOD, **frames, exposure_us=np.zeros((3, 2), np.int64))
    with pytest.raises(FormatError, match=r"exposure_us of shape \(3, 2\): give a begin and an end"):
        read(tmp_path / "a.npz")


def test_a_frame_of_another_size_changes_nothing(tmp_path: Path) -> None:
    with open_writer(tmp_path / "a.npz", width=346, height=260) as writer:
        wrong: list[Any] = [np.zeros((346, 260), np.uint8), np.zeros((260, 346))]
        for frame in wrong:
            with pytest.raises(ValueError, match=r"uint8 \(260, 346\)"):
                writer.frame(frame, 0)
    assert read(tmp_path / "a.npz").frames is None


def test_hours_take_little_memory(tmp_path: Path) -> None:
    events = np.zeros(100_000, EVENT)
    tracemalloc.start()
    try:
        with open_writer(tmp_path / "a.npz", width=346, height=260) as writer:
            for _ in range(80):
                writer.events(events)
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert (tmp_path / "a.npz").stat().st_size > 13 * 8_000_000
    assert peak_bytes < 60e6


def test_an_old_recording_is_there_until_the_new_one_is_complete(tmp_path: Path, make_events) -> None:
    old, new = make_events(5, seed=1), make_events(6, seed=2)
    with open_writer(tmp_path / "a.npz", width=346, height=260) as writer:
        writer.events(old)
    with open_writer(tmp_path / "a.npz", width=346, height=260, overwrite=True) as writer:
        writer.events(new)
        np.testing.assert_array_equal(read(tmp_path / "a.npz").events, old)
    np.testing.assert_array_equal(read(tmp_path / "a.npz").events, new)


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_what_numpy_saved_is_read(save: Any, tmp_path: Path) -> None:
    save(tmp_path / "a.npz", **{name: column.astype(np.int64) for name, column in GOOD.items()}, more="text")
    recording = read(tmp_path / "a.npz")
    assert recording.events.tolist() == [(0, 3, 0, True), (5, 2, 0, False), (5, 1, 7, True)]
    assert (recording.width, recording.height) == (4, 8)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"p": None}, "no array 'p', only .'t', 'x', 'y'.: "),
        ({"y": np.array([1, 2])}, "y has 2 values, t has 3"),
        ({"t": np.array([0.0, 0.5, 1.0])}, "'t' is float64"),
        ({"x": np.zeros((3, 1), int)}, "'x' is int64 of shape"),
        ({"x": np.array([0, 70000, 0])}, "event 1: x=70000 is no uint16"),
        ({"p": np.array([0, 1, -1])}, "event 2: p=-1 is no bool"),
        ({"t": np.array([5, 4, 6])}, "event 1 .*t goes back"),
        ({"t": np.array([-5, 4, 6])}, "event 0 .*microseconds"),
        ({"x": np.array([None, 1, 2])}, "'x' cannot be read"),
        ({"frames": np.zeros((2, 8, 4), np.uint8)}, "no array 't_us'"),
        ({"frames": np.zeros((2, 8, 4), np.uint8), "t_us": np.array([1])}, "2 uint8 frames and 1 t_us"),
        ({"frames": np.zeros((1, 8, 4)), "t_us": np.array([1])}, "'frames' is float64"),
        ({"frames": np.zeros((1, 8, 4), int), "t_us": np.array([1])}, "1 int64 frames"),
        ({"frames": np.zeros((1, 8, 3), np.uint8), "t_us": np.array([1])}, "event 0 .*outside a width of 3"),
    ],
)
def test_what_is_no_recording_is_named(change: dict[str, Any], fault: str, tmp_path: Path) -> None:
    arrays = {name: array for name, array in (GOOD | change).items() if array is not None}
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(FormatError, match=fault) as error:
        read(tmp_path / "a.npz")
    assert str(error.value).startswith(str(tmp_path / "a.npz"))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kept", [0.0, 0.3, 0.9, 0.999])
def test_a_cut_file_is_named(kept: float, tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", **GOOD)
    whole = (tmp_path / "a.npz").read_bytes()
    (tmp_path / "a.npz").write_bytes(whole[: int(kept * len(whole))])
    with pytest.raises(FormatError, match=r"is cut short or no \.npz"):
        read(tmp_path / "a.npz")


def test_a_damaged_file_is_named(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", **GOOD)
    whole = bytearray((tmp_path / "a.npz").read_bytes())
    whole[whole.index(b"}") + 60] ^= 0xFF  # in the values of t
    (tmp_path / "a.npz").write_bytes(whole)
    with pytest.raises(FormatError, match="cut short"):
        read(tmp_path / "a.npz")


def test_the_size_in_the_comment_of_older_files_is_read(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=[1], x=[2], y=[3], p=[1])
    with zipfile.ZipFile(tmp_path / "a.npz", "a") as archive:
        archive.comment = b'{"width": 346, "height": 260}'
    recording = read(tmp_path / "a.npz")
    assert (recording.width, recording.height) == (346, 260)
