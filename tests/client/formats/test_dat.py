"""`.dat` against other people's readers and writers."""

from pathlib import Path

import numpy as np
import pytest
from expelliarmus import Wizard

from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError, open_writer, read

EPOCH_US = 1_700_000_000_000_000


def test_the_bytes(tmp_path: Path) -> None:
    with open_writer(tmp_path / "a.dat", width=346, height=260) as writer:
        writer.events(np.array([(EPOCH_US, 345, 259, True)], EVENT))
    t0_us = EPOCH_US >> 23 << 23
    head = f"% Data file containing CD events.\n% Version 2\n% Width 346\n% Height 260\n% T0 {t0_us}\n"
    record = np.array([EPOCH_US - t0_us, 345 | 259 << 14 | 1 << 28], "<u4")
    assert (tmp_path / "a.dat").read_bytes() == head.encode() + b"\x0c\x08" + record.tobytes()


@pytest.mark.parametrize("start_us", [0, EPOCH_US])
def test_expelliarmus_reads_it(start_us: int, tmp_path: Path, make_events) -> None:
    """Times from the file's beginning: it does not know T0."""
    events = make_events(20_000, start_us)
    with open_writer(tmp_path / "a.dat", width=346, height=260) as writer:
        writer.events(events)
    theirs = Wizard(encoding="dat").read(tmp_path / "a.dat")
    events["t"] -= start_us >> 23 << 23
    for name in "txyp":
        np.testing.assert_array_equal(theirs[name], events[name])


def test_faery_reads_it_and_writes_what_is_read(tmp_path: Path, make_events) -> None:
    faery = pytest.importorskip("faery", reason="faery, another reader of DAT, is not installed")
    events = make_events(5000, EPOCH_US)
    with open_writer(tmp_path / "a.dat", width=346, height=260) as writer:
        writer.events(events)
    stream = faery.events_stream_from_file(tmp_path / "a.dat")
    theirs = np.concatenate(list(stream))
    assert stream.dimensions() == (346, 260)
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        np.testing.assert_array_equal(theirs[their_name], events[name])
    faery.events_stream_from_array(theirs, (346, 260)).to_file(tmp_path / "theirs.dat")
    recording = read(tmp_path / "theirs.dat")
    np.testing.assert_array_equal(recording.events, events)
    assert (recording.width, recording.height) == (346, 260)


def test_a_clock_that_goes_round(tmp_path: Path) -> None:
    """As cameras write it that ran for longer than 71 minutes."""
    records = np.array([2**32 - 1, 1, 4, 2, 2**31, 3], "<u4")
    (tmp_path / "a.dat").write_bytes(b"% Version 2\n\x00\x08" + records.tobytes() + b"cut")
    events = read(tmp_path / "a.dat").events
    assert events["t"].tolist() == [2**32 - 1, 2**32 + 4, 2**32 + 2**31]
    assert events["x"].tolist() == [1, 2, 3]


def test_version_1_has_fewer_bits(tmp_path: Path) -> None:
    record = np.array([7, 303 | 239 << 9 | 1 << 17], "<u4")
    (tmp_path / "a.dat").write_bytes(b"% Version 1\n\x00\x08" + record.tobytes())
    assert read(tmp_path / "a.dat").events.tolist() == [(7, 303, 239, True)]


def test_what_is_no_dat(tmp_path: Path) -> None:
    for content, fault in (
        (b"", "does not begin with lines of %"),
        (b"% Version 2\n\x0e\x08", "no events of 8 bytes"),
        (b"% Width x\n% Height 2\n\x0c\x08", "header that makes no sense"),
    ):
        (tmp_path / "a.dat").write_bytes(content)
        with pytest.raises(FormatError, match=fault):
            read(tmp_path / "a.dat")
    with pytest.raises(FormatError, match=r"\.dat has at most 16384x16384 pixels, not 16385x1"):
        open_writer(tmp_path / "b.dat", width=16385, height=1)
