"""A recording under way, in a folder: it is there at every moment, whole records only."""

import json
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, open_writer, read
from voltcam_client.formats.spool import Spool, geometry_from_json, geometry_to_json, read_spool


@pytest.mark.parametrize("kept_bytes", [0, 12, 13, 25])
def test_a_spool_is_cut_to_whole_records(kept_bytes: int, tmp_path: Path, make_events) -> None:
    events = make_events(2)
    writer = open_writer(tmp_path / "a.npz", width=346, height=260)
    writer.events(events)
    for t_us in (1, 2):
        writer.frame(np.full((260, 346), t_us, np.uint8), t_us)
    spool = tmp_path / "a.npz.partial"
    for name, size in (("events.bin", kept_bytes), ("frame_t_us.bin", 15)):
        with (spool / name).open("r+b") as file:
            file.truncate(size)
    recording = read(spool)
    np.testing.assert_array_equal(recording.events, events[: kept_bytes // 13])
    assert (recording.width, recording.height) == (346, 260)
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    np.testing.assert_array_equal(recording.frame_t_us, [1])
    np.testing.assert_array_equal(recording.frames, np.ones((1, 260, 346)))
    writer.close()


@pytest.mark.parametrize("geometry", [None, "", "[]", '{"width": 3}', '{"width": null, "height": 4}'])
def test_a_spool_that_never_began(geometry: str | None, tmp_path: Path) -> None:
    (tmp_path / "a.npz.partial").mkdir()
    if geometry is not None:
        (tmp_path / "a.npz.partial" / "geometry.json").write_text(geometry)
    with pytest.raises(FormatError, match="holds no recording"):
        read(tmp_path / "a.npz.partial")


def test_the_folder_can_be_read_by_numpy_and_json_alone(tmp_path: Path, make_events) -> None:
    """As its module says: what reads it after a crash may not be Voltcam."""
    events, frames = make_events(5), np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4)
    spool = Spool(tmp_path / "a", width=4, height=3)
    spool.append_events(events[:2])
    spool.append_events(events[2:])
    for frame, t_us in zip(frames, (10, 2**40), strict=True):
        spool.append_frame(frame, t_us, (t_us, t_us))
    folder = tmp_path / "a"  # not closed yet
    assert json.loads((folder / "geometry.json").read_text()) == {"width": 4, "height": 3}
    record = np.dtype({"names": list("txyp"), "formats": ["<i8", "<u2", "<u2", "?"], "itemsize": 13})
    np.testing.assert_array_equal(np.fromfile(folder / "events.bin", record), events)
    np.testing.assert_array_equal(np.fromfile(folder / "frames.bin", np.uint8).reshape(2, 3, 4), frames)
    assert np.fromfile(folder / "frame_t_us.bin", "<i8").tolist() == [10, 2**40]
    spool.close()


def test_a_spool_without_a_frame_has_none(tmp_path: Path, make_events) -> None:
    spool = Spool(tmp_path / "a", 346, 260)
    spool.append_events(make_events(3))
    spool.close()
    recording = read_spool(tmp_path / "a")
    assert len(recording.events) == 3
    assert recording.frames is recording.frame_t_us is None


def test_events_are_mapped_not_copied(tmp_path: Path, make_events) -> None:
    spool = Spool(tmp_path / "a", 346, 260)
    spool.append_events(make_events(3))
    spool.close()
    events = read_spool(tmp_path / "a").events
    assert isinstance(events, np.memmap)
    with pytest.raises(ValueError, match="read-only"):
        events["t"] = 0


def test_a_folder_of_that_name_is_replaced(tmp_path: Path, make_events) -> None:
    for count in (5, 2):
        spool = Spool(tmp_path / "a", 346, 260)
        spool.append_events(make_events(count))
        spool.close()
    assert len(read_spool(tmp_path / "a").events) == 2


def test_a_spool_that_cannot_be_begun_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(OSError, match="No space"):
        Spool(tmp_path / "a", 4, 3)
    assert not any(tmp_path.iterdir())


def test_geometry_survives_its_text() -> None:
    assert geometry_from_json(geometry_to_json(346, 260).encode()) == (346, 260)
    for text in (b"", b"[]", b"{}", b'{"width": 3}', b'{"width": [], "height": 1}', b"\xff"):
        with pytest.raises(ValueError):  # noqa: PT011 - of several kinds
            geometry_from_json(text)
