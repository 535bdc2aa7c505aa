"""Full disks and interrupts: what was reported as written can be read."""

import contextlib
import errno
import os
import resource
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.client.formats.suffixes import FROM_BEGINNING, SPOOLED

from voltcam_client.formats import SUFFIXES, RecordingError, Writer, open_writer, read
from voltcam_client.formats.writer import AppendFile
from voltcam_client.packet import EVENT

EVERY_FORMAT = pytest.mark.parametrize("suffix", sorted(SUFFIXES))


@contextlib.contextmanager
def largest_file(limit_bytes: int) -> Iterator[None]:
    """The operating system lets no file grow beyond the limit: it takes what fits, then fails."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def write_packets(writer: Writer, packets: list[Any]) -> None:
    for packet in packets:
        writer.events(packet)


@EVERY_FORMAT
@settings(max_examples=25, deadline=None)
@given(room_bytes=st.integers(200, 12_000), packet_size=st.integers(1, 400))
def test_a_disk_full_at_any_byte_costs_nothing_that_was_reported(
    suffix: str, room_bytes: int, packet_size: int
) -> None:
    events = np.zeros(2000, EVENT)
    events["t"] = 1_700_000_000_000_000 + 50_000 * np.arange(2000)
    events["x"] = np.arange(2000) % 346
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"full{suffix}"
        with open_writer(path, width=346, height=260) as writer:
            with largest_file(room_bytes), pytest.raises(RecordingError) as error:
                write_packets(writer, np.split(events, range(packet_size, 2000, packet_size)))
            with pytest.raises(RecordingError) as again:
                writer.events(events[-1:])
            assert str(again.value) == str(error.value)
        where = f"{path}.partial" if suffix.endswith(SPOOLED) else str(path)
        recovered = read(where).events
        assert f"File too large: {writer.event_count} events are safe in {where}: " in str(error.value)
        assert "\n" not in str(error.value)
        assert recovered.size == writer.event_count
        if suffix in FROM_BEGINNING and recovered.size:
            recovered["t"] += events["t"][0] >> 23 << 23
        np.testing.assert_array_equal(recovered, events[: recovered.size])


def test_a_disk_full_on_close_leaves_the_spool(tmp_path: Path, make_events) -> None:
    events = make_events(1000)
    path = tmp_path / "a.npz"
    writer = open_writer(path, width=346, height=260)
    writer.events(events)
    with (
        largest_file(13_100),
        pytest.raises(RecordingError, match="1000 events are safe in") as error,
    ):
        writer.close()  # the spool has 13000 bytes, the .npz some more
    assert f"voltcam convert {path}.partial recovered.npz" in str(error.value)
    assert not path.exists()
    np.testing.assert_array_equal(read(f"{path}.partial").events, events)
    with pytest.raises(RecordingError, match=r"unfinished recording.*convert.*or remove it"):
        open_writer(path, width=346, height=260)
    with open_writer(tmp_path / "recovered.npz", width=346, height=260) as recovered:
        recovered.events(read(f"{path}.partial").events)
    np.testing.assert_array_equal(read(tmp_path / "recovered.npz").events, events)


@pytest.mark.parametrize("suffix", [".csv", ".raw"])
def test_a_disk_full_from_the_start(suffix: str, tmp_path: Path) -> None:
    (tmp_path / f"a{suffix}").symlink_to("/dev/full")
    with pytest.raises(RecordingError, match="cannot be created: No space left on device"):
        open_writer(tmp_path / f"a{suffix}", width=346, height=260, overwrite=True)


@EVERY_FORMAT
def test_an_interrupted_write_leaves_no_half_record(
    suffix: str, tmp_path: Path, make_events, monkeypatch: pytest.MonkeyPatch
) -> None:
    events = make_events(300)
    path = tmp_path / f"a{suffix}"
    write = os.write

    def interrupted(descriptor: int, data: memoryview) -> int:
        write(descriptor, data[: len(data) // 2 + 1])
        raise KeyboardInterrupt

    with open_writer(path, width=346, height=260) as writer:
        writer.events(events[:100])
        monkeypatch.setattr(os, "write", interrupted)
        with pytest.raises(KeyboardInterrupt):
            writer.events(events[100:200])
        monkeypatch.undo()
        writer.events(events[200:])
        assert writer.event_count == 200
    np.testing.assert_array_equal(read(path).events, np.delete(events, np.s_[100:200]))


def test_a_failed_write_is_the_last(tmp_path: Path, make_events, monkeypatch: pytest.MonkeyPatch) -> None:
    """ENOSPC half way through a frame: neither the frame nor the events after it are there."""
    frame = np.zeros((260, 346), np.uint8)
    writer = open_writer(tmp_path / "a.npz", width=346, height=260)
    writer.events(make_events(10))
    writer.frame(frame, 1)
    write = os.write

    def full(descriptor: int, data: memoryview) -> int:
        if len(data) < 1000:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(descriptor, data[:1000])

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(RecordingError, match="No space left on device: 10 events are safe in"):
        writer.frame(frame, 2)
    monkeypatch.undo()
    with pytest.raises(RecordingError, match="No space left"):
        writer.events(make_events(1, start_us=10**6))
    writer.close()
    recording = read(tmp_path / "a.npz.partial")
    assert recording.frames is not None
    assert recording.frames.shape == (1, 260, 346)
    assert recording.events.size == 10


def test_an_append_file_goes_on_from_its_end(tmp_path: Path) -> None:
    for text in (b"one", b"two"):
        file = AppendFile.continued(tmp_path / "a")
        file.append(text)
        file.close()
    assert (tmp_path / "a").read_bytes() == b"onetwo"
