"""`.evt2.raw` against other people's readers, and against the format's page read word by word."""

from pathlib import Path

import numpy as np
import pytest
from expelliarmus import Wizard

from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError, open_writer, read
from voltcam_client.formats.evt2 import decode_evt2

EPOCH_US = 1_700_000_000_000_000


def test_the_words_by_the_page(tmp_path: Path) -> None:
    """An ON event at 64 + 3 us, an OFF event in the next 64 us: a time high before each."""
    path = tmp_path / "a.evt2.raw"
    with open_writer(path, width=346, height=260) as writer:
        writer.events(np.array([(67, 345, 259, True), (130, 1, 2, False)], EVENT))
    head, _, words = path.read_bytes().partition(b"% end\n")
    assert head == (b"% evt 2.0\n% format EVT2;height=260;width=346\n% geometry 346x260\n% t0 0\n")
    assert np.frombuffer(words, "<u4").tolist() == [
        8 << 28,
        8 << 28 | 1, 1 << 28 | 3 << 22 | 345 << 11 | 259,
        8 << 28 | 2, 0 << 28 | 2 << 22 | 1 << 11 | 2,
    ]  # fmt: skip


@pytest.mark.parametrize("start_us", [0, EPOCH_US])
def test_expelliarmus_reads_it(start_us: int, tmp_path: Path, make_events) -> None:
    """Times from the file's beginning: it does not know t0."""
    events = make_events(20_000, start_us)
    with open_writer(tmp_path / "a.evt2.raw", width=346, height=260) as writer:
        for packet in np.array_split(events, 30):
            writer.events(packet)
    theirs = Wizard(encoding="evt2").read(tmp_path / "a.evt2.raw")
    events["t"] -= start_us >> 23 << 23
    for name in "txyp":
        np.testing.assert_array_equal(theirs[name], events[name])


def test_faery_reads_it(tmp_path: Path, make_events) -> None:
    faery = pytest.importorskip("faery", reason="faery, another EVT2 reader, is not installed")
    events = make_events(5000, EPOCH_US)
    with open_writer(tmp_path / "a.evt2.raw", width=346, height=260) as writer:
        writer.events(events)
    stream = faery.events_stream_from_file(tmp_path / "a.evt2.raw")
    theirs = np.concatenate(list(stream))
    assert stream.dimensions() == (346, 260)
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        np.testing.assert_array_equal(theirs[their_name], events[name])


def test_expelliarmus_writes_what_is_read(tmp_path: Path, make_events) -> None:
    events = make_events(5000)
    wizard = Wizard(encoding="evt2")
    theirs = np.empty(events.size, [("t", "<i8"), ("x", "<i2"), ("y", "<i2"), ("p", "u1")])
    for name in "txyp":
        theirs[name] = events[name]
    wizard.save(fpath=tmp_path / "a.raw", arr=theirs)
    np.testing.assert_array_equal(read(tmp_path / "a.raw").events, events)


def test_a_clock_that_goes_round_and_words_of_other_kinds() -> None:
    last = (1 << 28) - 1
    words = [8 << 28 | last, 0xA << 28 | 5, 1 << 28 | 63 << 22, 0xE << 28, 8 << 28, 1 << 28 | 1 << 22]
    events = decode_evt2(np.array(words, "<u4").tobytes() + b"\0\0")
    assert events["t"].tolist() == [(1 << 34) - 1, (1 << 34) + 1]


def test_a_sensor_too_large_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"\.evt2\.raw has at most 2048x2048 pixels, not 10x2049"):
        open_writer(tmp_path / "a.evt2.raw", width=10, height=2049)
    assert not list(tmp_path.iterdir())
