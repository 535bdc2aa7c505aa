"""`.aedat4` as we write it: dv-processing, aedat and faery are the readers."""

import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError, RecordingError, open_writer, read
from voltcam_client.formats.aedat4_writer import Aedat4Writer
from voltcam_client.samples import IMU, TRIGGER

from .test_writer import largest_file

START_US = 1_700_000_000_000_000
READ_BY_DV = """
import sys
import dv_processing as dv
import numpy as np

recording = dv.io.MonoCameraRecording(sys.argv[1])
batches = []
while recording.isRunning() and (batch := recording.getNextEventBatch()) is not None:
    batches.append(batch.numpy())
np.save(sys.argv[2], np.concatenate(batches) if batches else np.empty(0, "i8"))
"""


def _read_by_dv(path: Path) -> np.ndarray:
    """In a process of its own: what it does with a damaged file is not ours to say."""
    pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    theirs = path.with_name("theirs.npy")
    subprocess.run([sys.executable, "-c", READ_BY_DV, str(path), str(theirs)], check=True, timeout=60)
    return np.load(theirs)


def _assert_theirs(theirs: np.ndarray, names: tuple[str, ...], events: np.ndarray) -> None:
    assert theirs.size == events.size
    for name, own in zip(names, "txyp", strict=True):
        np.testing.assert_array_equal(theirs[name], events[own])


def _record(path: Path, events: np.ndarray, images: np.ndarray) -> None:
    """A frame with an exposure, a sample and a trigger after each part of the events."""
    with open_writer(path, width=346, height=260) as writer:
        for part, image in zip(np.array_split(events, len(images)), images, strict=True):
            t = int(part["t"][-1])
            writer.events(part)
            writer.aps_frame(image, (t, t + 500), (t - 9000, t + 9500))
            writer.imu(np.array([(t, 25.5, (0, -1, 0), (1, 2, 3))], IMU))
            writer.triggers(np.array([(t, 1), (t + 1, 2)], TRIGGER))


@pytest.fixture
def images() -> np.ndarray:
    return np.random.default_rng(3).integers(0, 256, (5, 260, 346), np.uint8)


def test_dv_processing_reads_every_event(tmp_path: Path, make_events) -> None:
    events = make_events(200_000, START_US)
    with open_writer(tmp_path / "a.aedat4", width=346, height=260) as writer:
        writer.events(events)
    _assert_theirs(_read_by_dv(tmp_path / "a.aedat4"), ("timestamp", "x", "y", "polarity"), events)


def test_dv_processing_reads_all_else(tmp_path: Path, make_events, images) -> None:
    dv = pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    events = make_events(1000, START_US)
    _record(tmp_path / "a.aedat4", events, images)
    recording = dv.io.MonoCameraRecording(str(tmp_path / "a.aedat4"))
    assert recording.getCameraName() == "DAVIS346_EMU00001"
    assert (recording.getEventResolution(), recording.getFrameResolution()) == ((346, 260), (346, 260))
    times = [int(part["t"][-1]) for part in np.array_split(events, 5)]
    for t, image in zip(times, images, strict=True):
        frame = recording.getNextFrame()
        assert (frame.timestamp, frame.exposure.microseconds) == (t, 500)
        np.testing.assert_array_equal(frame.image, image)
        (sample,) = recording.getNextImuBatch()
        assert (sample.timestamp, sample.temperature) == (t, 25.5)
        assert [sample.accelerometerX, sample.accelerometerY, sample.accelerometerZ] == [0, -1, 0]
        assert [sample.gyroscopeX, sample.gyroscopeY, sample.gyroscopeZ] == [1, 2, 3]
        triggers = recording.getNextTriggerBatch()
        assert [(each.timestamp, each.type) for each in triggers] == [
            (t, dv.TriggerType.EXTERNAL_SIGNAL_RISING_EDGE),
            (t + 1, dv.TriggerType.EXTERNAL_SIGNAL_FALLING_EDGE),
        ]
    assert recording.getNextFrame() is None


def test_aedat_reads_every_event_and_frame(tmp_path: Path, make_events, images) -> None:
    aedat = pytest.importorskip("aedat", reason="aedat, another reader, is not installed")
    events = make_events(1000, START_US)
    _record(tmp_path / "a.aedat4", events, images)
    packets = list(aedat.Decoder(tmp_path / "a.aedat4"))
    _assert_theirs(
        np.concatenate([each["events"] for each in packets if "events" in each]),
        ("t", "x", "y", "on"),
        events,
    )
    frames = [each["frame"] for each in packets if "frame" in each]
    np.testing.assert_array_equal([frame["pixels"] for frame in frames], images)
    times = np.array([part["t"][-1] for part in np.array_split(events, 5)])
    np.testing.assert_array_equal([frame["exposure_begin_t"] for frame in frames], times)
    np.testing.assert_array_equal([frame["exposure_end_t"] for frame in frames], times + 500)
    np.testing.assert_array_equal([frame["begin_t"] for frame in frames], times - 9000)
    np.testing.assert_array_equal([frame["end_t"] for frame in frames], times + 9500)
    assert sum(len(each["imus"]) for each in packets if "imus" in each) == 5
    assert sum(len(each["triggers"]) for each in packets if "triggers" in each) == 10


def test_faery_reads_every_event(tmp_path: Path, make_events, images) -> None:
    faery = pytest.importorskip("faery", reason="faery, another reader, is not installed")
    events = make_events(1000, START_US)
    _record(tmp_path / "a.aedat4", events, images)
    theirs = np.concatenate(list(faery.events_stream_from_file(tmp_path / "a.aedat4")))
    _assert_theirs(theirs, ("t", "x", "y", "on"), events)


def test_frames_and_exposures_are_read_back(tmp_path: Path, make_events, images) -> None:
    events = make_events(1000, START_US)
    _record(tmp_path / "a.aedat4", events, images)
    recording = read(tmp_path / "a.aedat4")
    np.testing.assert_array_equal(recording.events, events)
    np.testing.assert_array_equal(recording.frames, images)
    times = np.array([part["t"][-1] for part in np.array_split(events, 5)])
    np.testing.assert_array_equal(recording.exposure_us, np.stack([times, times + 500], axis=1))


def test_a_crash_leaves_frames_and_samples_too(tmp_path: Path, make_events, images) -> None:
    """A file that is not closed names what it has."""
    dv = pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    writer = open_writer(tmp_path / "a.aedat4", width=346, height=260)
    writer.events(make_events(10, START_US))
    for number, image in enumerate(images):
        writer.frame(image, START_US + number)
    writer.imu(np.array([(START_US, 25.5, (0, -1, 0), (1, 2, 3))], IMU))
    (tmp_path / "crashed.aedat4").write_bytes((tmp_path / "a.aedat4").read_bytes())
    writer.close()
    np.testing.assert_array_equal(read(tmp_path / "crashed.aedat4").frames, images)
    theirs = dv.io.MonoCameraRecording(str(tmp_path / "crashed.aedat4"))
    assert theirs.getStreamNames() == ["events", "frames", "imu"]
    np.testing.assert_array_equal(theirs.getNextFrame().image, images[0])


def test_streams_that_hold_nothing_are_not_named(tmp_path: Path, make_events) -> None:
    """dv-processing takes a recording for ended as soon as one of its streams has nothing left."""
    dv = pytest.importorskip("dv_processing", reason="dv-processing, the oracle, is not installed")
    with open_writer(tmp_path / "a.aedat4", width=346, height=260) as writer:
        writer.imu(np.empty(0, IMU))
        writer.triggers(np.empty(0, TRIGGER))
        writer.events(make_events(10))
    recording = dv.io.MonoCameraRecording(str(tmp_path / "a.aedat4"))
    assert recording.getStreamNames() == ["events"]
    assert recording.isRunning()


@settings(max_examples=20, deadline=None)
@given(cut=st.floats(0, 1))
def test_a_crash_anywhere_leaves_what_came_before(cut: float, tmp_path_factory) -> None:
    """By our reader the events before the cut, by dv-processing those in whole packets."""
    folder = tmp_path_factory.mktemp("cut")
    events = np.zeros(900, EVENT)
    events["t"] = START_US + 10 * np.arange(900)
    writer = open_writer(folder / "a.aedat4", width=346, height=260)
    begin = writer.path.stat().st_size
    ends = []
    for part in np.array_split(events, 9):
        writer.events(part)
        ends.append(writer.path.stat().st_size)
    kept = begin + round(cut * (ends[-1] - begin))
    (folder / "cut.aedat4").write_bytes((folder / "a.aedat4").read_bytes()[:kept])
    writer.close()
    whole = 100 * sum(end <= kept for end in ends)
    ours = read(folder / "cut.aedat4").events
    np.testing.assert_array_equal(ours, events[: ours.size])
    expected = whole + max(0, kept - max([begin, *(end for end in ends if end <= kept)]) - 40) // 16
    assert ours.size == expected
    theirs = _read_by_dv(folder / "cut.aedat4")
    assert theirs.size == whole
    if whole:
        _assert_theirs(theirs, ("timestamp", "x", "y", "polarity"), events[:whole])


def test_a_disk_full_on_close_costs_the_table_only(tmp_path: Path, make_events) -> None:
    events, path = make_events(1000), tmp_path / "a.aedat4"
    writer = open_writer(path, width=346, height=260)
    for part in np.array_split(events, 10):
        writer.events(part)
    size = path.stat().st_size
    with largest_file(size + 100), pytest.raises(RecordingError, match="1000 events are safe in"):
        writer.close()
    assert path.stat().st_size == size
    np.testing.assert_array_equal(read(path).events, events)
    _assert_theirs(_read_by_dv(path), ("timestamp", "x", "y", "polarity"), events)


def test_hours_take_little_memory(tmp_path: Path) -> None:
    """70 000 packets: their table alone has 3.6 MB."""
    events = np.zeros(1, EVENT)
    with open_writer(tmp_path / "a.aedat4", width=346, height=260) as writer:
        for _ in range(70_000):
            writer.events(events)
        tracemalloc.start()
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 3_000_000
    assert read(tmp_path / "a.aedat4").events.size == 70_000


def test_a_frame_of_another_size_changes_nothing(tmp_path: Path) -> None:
    with (
        open_writer(tmp_path / "a.aedat4", width=346, height=260) as writer,
        pytest.raises(ValueError, match=r"uint8 \(260, 346\)"),
    ):
        writer.frame(np.zeros((346, 260), np.uint8), 0)
    assert read(tmp_path / "a.aedat4").frames is None


def test_a_sensor_that_the_records_cannot_hold_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="32768 pixels a side at most"):
        Aedat4Writer(tmp_path / "a.aedat4", 40_000, 10, overwrite=False)
    assert not any(tmp_path.iterdir())
