"""`.h5` as plain h5py sees it, laid out as DSEC's page says."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_client.formats import hdf5_writer, open_writer, read
from voltcam_client.formats.bounds import SMALL_BYTES

h5py = pytest.importorskip("h5py", reason="h5py, the oracle, is in the extra [lab]")
pytest.importorskip("hdf5plugin", reason="hdf5plugin is in the extra [lab]")

EPOCH_US = 1_700_000_000_000_000


def write(path: Path, events: np.ndarray, frames: int = 0) -> None:
    with open_writer(path, width=346, height=260) as writer:
        for packet in np.array_split(events, 5):
            writer.events(packet)
        for number in range(frames):
            writer.frame(np.full((260, 346), number, np.uint8), EPOCH_US + number)


def test_dsec(tmp_path: Path, make_events) -> None:
    """Types as DSEC has them, and its index: t[ms_to_idx[ms]] is the first at or after 1000 ms."""
    events = make_events(5000, EPOCH_US)
    write(tmp_path / "a.h5", events)
    with h5py.File(tmp_path / "a.h5") as file:
        for name, kind in (("t", "<u4"), ("x", "<u2"), ("y", "<u2"), ("p", "u1")):
            column = file[f"events/{name}"]
            assert (column.dtype, column.shape) == (np.dtype(kind), (5000,))
            assert column.chunks
            assert column.id.get_create_plist().get_nfilters() == 1
            offset = int(file["t_offset"][()]) if name == "t" else 0
            np.testing.assert_array_equal(column[()].astype(np.int64) + offset, events[name])
        t, index = file["events/t"][()], file["ms_to_idx"][()]
        assert index.size == t[-1] // 1000 + 1
        for ms, first in enumerate(index.tolist()):
            assert t[first] >= 1000 * ms
            assert first == 0 or t[first - 1] < 1000 * ms
        assert (file.attrs["width"], file.attrs["height"]) == (346, 260)
        assert file.attrs["sensor_resolution"].tolist() == [260, 346]
        assert "frames" not in file


def test_the_index_goes_on_through_blocks(tmp_path: Path) -> None:
    """Of 16 MB each, with silence where one ends, and many events in a millisecond."""
    count = 2 * 2**24 // EVENT.itemsize + 10
    events = np.zeros(count, EVENT)
    events["t"] = 700 + np.arange(count) // 100
    events["t"][2**24 // EVENT.itemsize :] += 10_000
    write(tmp_path / "a.h5", events)
    with h5py.File(tmp_path / "a.h5") as file:
        ms = np.arange(events["t"][-1] // 1000 + 1)
        np.testing.assert_array_equal(file["ms_to_idx"][()], np.searchsorted(events["t"], 1000 * ms))
        np.testing.assert_array_equal(file["events/t"][()], events["t"])


def test_times_of_a_source_that_begins_at_0_need_no_offset(tmp_path: Path, make_events) -> None:
    write(tmp_path / "a.h5", make_events(10, start_us=1_000_000))
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["t_offset"][()] == 0


def test_a_recording_longer_than_71_minutes_has_wide_times_and_no_index(tmp_path: Path) -> None:
    events = np.array([(5, 1, 2, True), (5 + 2**32, 1, 2, False)], EVENT)
    write(tmp_path / "a.h5", events)
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["events/t"].dtype == "<i8"
        assert "ms_to_idx" not in file
    np.testing.assert_array_equal(read(tmp_path / "a.h5").events, events)


def test_dark_frames_are_not_taken_for_a_bomb(tmp_path: Path) -> None:
    """They pack best, and a reader takes only so many bytes out of a file."""
    count = SMALL_BYTES // (346 * 260) + 300
    with open_writer(tmp_path / "a.h5", width=346, height=260) as writer:
        for number in range(count):
            writer.frame(np.zeros((260, 346), np.uint8), number)
    frames = read(tmp_path / "a.h5").frames
    assert frames is not None
    assert len(frames) == count


def test_who_holds_on_to_a_dataset_changes_no_byte(
    tmp_path: Path, make_events, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a profiler does, of which the function's variables then outlive it."""
    events = make_events(5000, EPOCH_US)
    write(tmp_path / "a.h5", events, frames=3)
    held, whole = [], hdf5_writer._dataset

    def hold(*arguments: object) -> object:
        held.append(whole(*arguments))
        return held[-1]

    with monkeypatch.context() as patch:
        patch.setattr(hdf5_writer, "_dataset", hold)
        write(tmp_path / "b.h5", events, frames=3)
    assert len(held) == 6
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()
