"""`.h5` as h5py writes it, laid out as the datasets' pages say."""

import builtins
import importlib
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, open_writer, read

h5py = pytest.importorskip("h5py", reason="h5py, the oracle, is in the extra [lab]")
hdf5plugin = pytest.importorskip("hdf5plugin", reason="hdf5plugin is in the extra [lab]")

FILTERS = {
    "blosc zstd": lambda: hdf5plugin.Blosc(cname="zstd", clevel=1, shuffle=1),
    "zstd": lambda: hdf5plugin.Zstd(),
    "plain": dict,
}


@pytest.mark.parametrize("compression", FILTERS)
def test_dsec(compression: str, tmp_path: Path, make_events) -> None:
    events = make_events(5000)
    with h5py.File(tmp_path / "events.h5", "w") as file:
        for name, kind in (("t", "<u4"), ("x", "<u2"), ("y", "<u2"), ("p", "u1")):
            file.create_dataset(f"events/{name}", data=events[name].astype(kind), **FILTERS[compression]())
        file["t_offset"] = np.int64(51_648_500_652)
        file["ms_to_idx"] = np.searchsorted(events["t"], 1000 * np.arange(events["t"][-1] // 1000))
    recording = read(tmp_path / "events.h5")
    events["t"] += 51_648_500_652
    np.testing.assert_array_equal(recording.events, events)
    assert recording.frames is None
    assert (recording.width, recording.height) == (events["x"].max() + 1, events["y"].max() + 1)


def test_missing_offset_and_index_are_no_fault_and_frames_may_be_there(tmp_path: Path, make_events) -> None:
    events = make_events(50)
    frames = np.arange(2 * 260 * 346, dtype=np.uint8).reshape(2, 260, 346)
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        for name in "txyp":
            file[f"events/{name}"] = events[name]
        file["frames"], file["t_us"] = frames, np.array([100, 200])
    recording = read(tmp_path / "a.hdf5")
    np.testing.assert_array_equal(recording.events, events)
    np.testing.assert_array_equal(recording.frames, frames)
    assert recording.frame_t_us.tolist() == [100, 200]


def test_event_utils(tmp_path: Path, make_events) -> None:
    events = make_events(50, start_us=1_500_000_000_000_000)
    colour = np.zeros((260, 346, 3), np.uint8)
    colour[..., 2] = 255  # red, in OpenCV's order
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["events/ts"] = events["t"] / 1e6
        file["events/xs"], file["events/ys"] = events["x"], events["y"]
        file["events/ps"] = np.where(events["p"], 1, -1).astype(np.int8)
        for i in range(3):
            file[f"images/image{i:09d}"] = colour
            file[f"images/image{i:09d}"].attrs["timestamp"] = 1.5e9 + 0.04 * i
        file.attrs["sensor_resolution"] = (260, 346)
    recording = read(tmp_path / "a.h5")
    np.testing.assert_array_equal(recording.events, events)
    assert recording.frame_t_us.tolist() == [1_500_000_000_000_000 + 40_000 * i for i in range(3)]
    assert set(recording.frames.ravel()) == {76}  # 0.299 * 255
    assert (recording.width, recording.height) == (346, 260)


@pytest.mark.parametrize("camera", ["left", "right"])
def test_mvsec(camera: str, tmp_path: Path, make_events) -> None:
    events = make_events(5000, start_us=1_504_645_177_000_000)
    frames = np.arange(2 * 260 * 346, dtype=np.uint8).reshape(2, 260, 346)
    with h5py.File(tmp_path / "indoor_flying1_data.hdf5", "w") as file:
        rows = [events["x"], events["y"], events["t"] / 1e6, np.where(events["p"], 1, -1)]
        file[f"davis/{camera}/events"] = np.stack(rows, axis=1)
        file[f"davis/{camera}/image_raw"] = frames
        file[f"davis/{camera}/image_raw_ts"] = 1_504_645_177 + np.array([0.002, 0.034])
        file[f"davis/{camera}/image_raw_event_inds"] = [10, 20]
        file["velodyne/scans_ts"] = [0.5]
    recording = read(tmp_path / "indoor_flying1_data.hdf5")
    np.testing.assert_array_equal(recording.events, events)
    np.testing.assert_array_equal(recording.frames, frames)
    assert recording.frame_t_us.tolist() == [1_504_645_177_002_000, 1_504_645_177_034_000]
    assert (recording.width, recording.height) == (346, 260)


def test_of_mvsec_the_left_camera_is_read_and_frames_may_be_missing(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["davis/right/events"] = [[1.0, 1.0, 0.5, 1.0]]
        file["davis/left/events"] = [[7.0, 3.0, 0.5, -1.0]]
    recording = read(tmp_path / "a.hdf5")
    assert recording.events.tolist() == [(500_000, 7, 3, False)]
    assert recording.frames is None


def test_frames_of_mvsec_without_their_times_are_named(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["davis/left/events"] = [[7.0, 3.0, 0.5, -1.0]]
        file["davis/left/image_raw"] = np.zeros((1, 260, 346), np.uint8)
    with pytest.raises(FormatError, match="has no davis/left/image_raw_ts"):
        read(tmp_path / "a.hdf5")


def test_other_rows_than_those_of_mvsec_are_named(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["davis/left/events"] = [[1.0, 1.0, 0.5]]
    with pytest.raises(FormatError, match=r"davis/left/events is \(1, 3\), not \(N, 4\)"):
        read(tmp_path / "a.hdf5")


@pytest.mark.parametrize("resolution", [(260, 346), (346, 260)])
def test_the_stated_size_counts_in_either_order(resolution: tuple[int, int], tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["events/ts"], file["events/ps"] = [0.5], [1]
        file["events/xs"], file["events/ys"] = [300], [100]
        file.attrs["sensor_resolution"] = resolution
    recording = read(tmp_path / "a.h5")
    assert (recording.width, recording.height) in {(346, 260), resolution[::-1]}
    assert recording.width > 300


def test_what_is_missing_is_named(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["events/t"] = [1]
        file["events/x"] = [1]
        file["events/p"] = [1]
    with pytest.raises(FormatError, match="no events/y: give columns t, x, y, p"):
        read(tmp_path / "a.h5")
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["disparity"] = [1]
    with pytest.raises(FormatError, match=r"no events/t, only \['disparity'\]"):
        read(tmp_path / "b.h5")
    (tmp_path / "c.h5").write_bytes(b"no HDF5 at all")
    with pytest.raises(FormatError, match=r"c\.h5 is cut short or no HDF5 file") as error:
        read(tmp_path / "c.h5")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("suffix", "library"), [(".h5", "h5py"), (".h5", "hdf5plugin"), (".bag", "rosbags")])
def test_a_missing_library_is_named_with_its_extra(
    suffix: str, library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def without(name: str) -> object:
        if name.partition(".")[0] == library:
            raise ModuleNotFoundError(name)
        return builtins.__import__(name)

    monkeypatch.setattr(importlib, "import_module", without)
    (tmp_path / f"a{suffix}").touch()
    with pytest.raises(
        FormatError, match=rf"reading it takes {library}.*: pip install 'voltcam\[lab\]'"
    ) as error:
        read(tmp_path / f"a{suffix}")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("suffix", "library"), [(".h5", "h5py"), (".hdf5", "hdf5plugin"), (".mcap", "rosbags")]
)
def test_a_library_missing_for_writing_is_named_before_anything_is_made(
    suffix: str, library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def without(name: str) -> object:
        if name.partition(".")[0] == library:
            raise ModuleNotFoundError(name)
        return builtins.__import__(name)

    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(FormatError, match=rf"writing it takes {library}.*: pip install 'voltcam\[lab\]'"):
        open_writer(tmp_path / f"a{suffix}", width=346, height=260)
    assert not any(tmp_path.iterdir())
