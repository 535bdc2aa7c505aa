"""What holds for every recording format."""

import itertools
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.client.formats.suffixes import FROM_BEGINNING, SPOOLED

from voltcam_client.formats import READABLE, SUFFIXES, FormatError, RecordingError, open_writer, read
from voltcam_client.packet import EVENT

Events = npt.NDArray[np.void]

EPOCH_US = 1_700_000_000_000_000
EVERY_FORMAT = pytest.mark.parametrize("suffix", sorted(SUFFIXES))

gaps_us = st.one_of(st.just(0), st.integers(0, 5000), st.integers(0, 40_000_000), st.integers(0, 10**11))
rows = st.tuples(gaps_us, st.integers(0, 345), st.integers(0, 259), st.booleans())
starts_us = st.sampled_from([0, 2**23 - 2, 2**24 - 1, EPOCH_US])


def as_events(start_us: int, rows: list[tuple[int, int, int, bool]]) -> Events:
    times = itertools.accumulate((gap for gap, *_ in rows), initial=start_us)
    next(times, None)
    return np.array([(t, *row[1:]) for t, row in zip(times, rows, strict=True)], EVENT)


SPANS_US = {".dat": 2**32, ".es": 2**34, ".evt2.raw": 2**34}
"""How long a file can be, where that is not thousands of years."""


def as_said(events: Events, suffix: str) -> Events:
    """What a format says of events: some say times from the file's beginning only."""
    events = events.copy()
    if suffix in FROM_BEGINNING and events.size:
        events["t"] -= events["t"][0] >> 23 << 23
    return events


def under_way(path: Path, suffix: str) -> Path:
    """Where a recording is until it is closed."""
    return Path(f"{path}.partial") if suffix.endswith(SPOOLED) else path


def assert_one_line(error: pytest.ExceptionInfo[Exception]) -> str:
    message = str(error.value)
    assert message
    assert "\n" not in message
    return message


@EVERY_FORMAT
@settings(max_examples=40, deadline=None)  # disks are slow at times
@given(start_us=starts_us, packets=st.lists(st.lists(rows, max_size=20), max_size=5))
def test_what_is_written_in_packets_is_read_back(
    suffix: str, start_us: int, packets: list[list[tuple[int, int, int, bool]]]
) -> None:
    events = as_events(start_us, [row for packet in packets for row in packet])
    if suffix in SPANS_US and events.size:
        longest_us = min(SPANS_US[suffix] - 2**24, 2**29)  # .es: a byte for each 127 us
        events["t"] = events["t"][0] + np.minimum(events["t"] - events["t"][0], longest_us)
    ends = np.cumsum([len(packet) for packet in packets], dtype=int)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"recording{suffix}"
        with open_writer(path, width=346, height=260) as writer:
            for packet in np.split(events, ends):
                writer.events(packet)
            assert writer.event_count == events.size
        recording = read(path)
        assert list(Path(folder).iterdir()) == [path]
    np.testing.assert_array_equal(recording.events, as_said(events, suffix))
    assert recording.events.dtype == EVENT
    if suffix != ".txt" and (events.size or not suffix.endswith(".hdf5")):
        assert (recording.width, recording.height) == (346, 260)


@EVERY_FORMAT
def test_an_empty_recording(suffix: str, tmp_path: Path) -> None:
    open_writer(tmp_path / f"empty{suffix}", width=346, height=260).close()
    assert read(tmp_path / f"empty{suffix}").events.size == 0


@EVERY_FORMAT
def test_more_events_than_one_write_takes(suffix: str, tmp_path: Path, make_events) -> None:
    events = make_events(200_000, start_us=EPOCH_US)
    with open_writer(tmp_path / f"long{suffix}", width=346, height=260) as writer:
        writer.events(events)
    np.testing.assert_array_equal(read(tmp_path / f"long{suffix}").events, as_said(events, suffix))


@EVERY_FORMAT
def test_an_existing_file_is_kept_unless_overwritten(suffix: str, tmp_path: Path, make_events) -> None:
    path = tmp_path / f"kept{suffix}"
    first, second = make_events(10, seed=1), make_events(5, seed=2)
    with open_writer(path, width=346, height=260) as writer:
        writer.events(first)
    with pytest.raises(RecordingError, match="--overwrite") as error:
        open_writer(path, width=346, height=260)
    assert str(path) in assert_one_line(error)
    np.testing.assert_array_equal(read(path).events, first)
    with open_writer(path, width=346, height=260, overwrite=True) as writer:
        writer.events(second)
    np.testing.assert_array_equal(read(path).events, second)


@EVERY_FORMAT
@pytest.mark.parametrize(
    ("row", "fault"),
    [
        ((99, 0, 0, True), "goes back"),
        ((-1, 0, 0, True), "microseconds"),
        ((2**62, 0, 0, True), "microseconds"),
        ((200, 346, 0, True), "width of 346"),
        ((200, 0, 260, True), "height of 260"),
    ],
)
def test_events_that_do_not_fit_change_nothing(
    suffix: str, row: tuple[int, int, int, bool], fault: str, tmp_path: Path
) -> None:
    good = np.array([(100, 1, 2, True)], EVENT)
    with open_writer(tmp_path / f"a{suffix}", width=346, height=260) as writer:
        writer.events(good)
        with pytest.raises(ValueError, match=fault) as error:
            writer.events(np.array([(150, 1, 1, True), row], EVENT))
        assert "event 1 " in assert_one_line(error)
        with pytest.raises(ValueError, match="EVENT"):
            writer.events(np.zeros(3, np.dtype([("t", "<i8")])))
        assert writer.event_count == 1
    np.testing.assert_array_equal(read(tmp_path / f"a{suffix}").events, good)


@EVERY_FORMAT
def test_a_closed_writer_takes_no_more(suffix: str, tmp_path: Path, make_events) -> None:
    writer = open_writer(tmp_path / f"a{suffix}", width=346, height=260)
    writer.close()
    writer.close()
    with pytest.raises(ValueError, match="closed"):
        writer.events(make_events(1))


@EVERY_FORMAT
def test_frames_are_kept_where_the_format_holds_them(suffix: str, tmp_path: Path, make_events) -> None:
    events = make_events(3)
    with open_writer(tmp_path / f"a{suffix}", width=346, height=260) as writer:
        writer.frame(np.full((260, 346), 7, np.uint8), 5)
        writer.events(events)
    recording = read(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(recording.events, events)
    assert (recording.frames is not None) == writer.holds_frames == suffix.endswith((*SPOOLED, ".aedat4"))
    if writer.holds_frames:
        assert recording.frames is not None
        assert recording.frame_t_us is not None
        assert (recording.frames.shape, set(recording.frames.ravel().tolist())) == ((1, 260, 346), {7})
        assert recording.frame_t_us.tolist() == [5]


@pytest.mark.parametrize("operation", ["read", "write"])
def test_an_unknown_suffix_lists_the_known_ones(operation: str, tmp_path: Path) -> None:
    path = tmp_path / "a.mp4"
    if operation == "read":
        path.touch()
    with pytest.raises(FormatError, match=r"'\.mp4'") as error:
        read(path) if operation == "read" else open_writer(path, width=1, height=1)
    message = assert_one_line(error)
    known = READABLE if operation == "read" else SUFFIXES
    for suffix, description in known.items():
        assert f"{suffix} ({description})" in message


@pytest.mark.parametrize("suffix", sorted(set(READABLE) - set(SUFFIXES)))
def test_what_is_only_read_is_not_written(suffix: str, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"can be read, not written: choose \.npz") as error:
        open_writer(tmp_path / f"a{suffix}", width=1, height=1)
    assert_one_line(error)
    assert not any(tmp_path.iterdir())


def test_what_is_not_there_cannot_be_read(tmp_path: Path) -> None:
    for name in ("a.npz", "a.txt", "a.csv", "a.raw", "a.npz.partial", "folder"):
        with pytest.raises(RecordingError, match="No such file") as error:
            read(tmp_path / name)
        assert str(tmp_path / name) in assert_one_line(error)
    with pytest.raises(FormatError, match=r"without an events\.txt"):
        read(tmp_path)


@EVERY_FORMAT
def test_a_folder_that_is_not_there(suffix: str, tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="No such file or directory: choose a folder") as error:
        open_writer(tmp_path / "none" / f"a{suffix}", width=1, height=1)
    assert_one_line(error)


@pytest.mark.parametrize("suffix", sorted(suffix for suffix in SUFFIXES if not suffix.endswith(SPOOLED)))
@settings(max_examples=30, deadline=None)
@given(data=st.data())
def test_a_file_cut_anywhere_holds_the_events_before_the_cut(suffix: str, data: st.DataObject) -> None:
    events = as_events(EPOCH_US, data.draw(st.lists(rows, min_size=1, max_size=10)))
    events["t"] = EPOCH_US + np.minimum(events["t"] - EPOCH_US, SPANS_US.get(suffix, 2**62) - 2**24)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"cut{suffix}"
        writer = open_writer(path, width=346, height=260)
        header_bytes = path.stat().st_size
        sizes = []
        for event in events:
            writer.events(event[np.newaxis])
            sizes.append(path.stat().st_size)  # nothing waits in the process
        cut = data.draw(st.integers(header_bytes, sizes[-1]))
        os.truncate(path, cut)
        recovered = read(path).events
        writer.close()
    assert recovered.size >= sum(size <= cut for size in sizes)
    np.testing.assert_array_equal(recovered, as_said(events, suffix)[: recovered.size])


@pytest.mark.parametrize("suffix", sorted(SPANS_US))
def test_events_too_late_for_the_format_change_nothing(suffix: str, tmp_path: Path, make_events) -> None:
    first, late = make_events(3, start_us=EPOCH_US), make_events(1, start_us=EPOCH_US + SPANS_US[suffix])
    with open_writer(tmp_path / f"a{suffix}", width=346, height=260) as writer:
        writer.events(first)
        with pytest.raises(ValueError, match="hours from its beginning: record on into another") as error:
            writer.events(late)
        assert_one_line(error)
    np.testing.assert_array_equal(read(tmp_path / f"a{suffix}").events, as_said(first, suffix))


def test_the_longest_ending_says_the_format(tmp_path: Path, make_events) -> None:
    for name, begin in (("a.b.raw", b"% evt 3.0"), ("a.EVT2.raw", b"% evt 2.0"), (".evt2.raw", b"% evt 3.0")):
        with open_writer(tmp_path / name, width=346, height=260) as writer:
            writer.events(make_events(10))
        assert (tmp_path / name).read_bytes().startswith(begin)
        np.testing.assert_array_equal(read(tmp_path / name).events, make_events(10))


ENDLESS_RECORDING = """
import sys
import numpy as np
from voltcam_client.formats import open_writer
from voltcam_client.packet import EVENT

writer = open_writer(sys.argv[1], width=346, height=260)
for packet in range(10**6):
    events = np.zeros(1000, EVENT)
    events["t"] = packet * 1000 + np.arange(1000)
    events["x"] = events["t"] % 346
    writer.events(events)
    print(writer.event_count, flush=True)
"""


@EVERY_FORMAT
def test_a_killed_recording_has_every_event_it_reported(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"killed{suffix}"
    command = [sys.executable, "-c", ENDLESS_RECORDING, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as recorder:
        assert recorder.stdout is not None
        lines = list(itertools.islice(recorder.stdout, 50))
        recorder.send_signal(signal.SIGKILL)
        lines += (line for line in recorder.stdout if line.endswith("\n"))
    reported = int(lines[-1])
    events = read(under_way(path, suffix)).events
    assert events.size >= reported >= 50_000
    np.testing.assert_array_equal(events["t"], np.arange(events.size))
    np.testing.assert_array_equal(events["x"], np.arange(events.size) % 346)
