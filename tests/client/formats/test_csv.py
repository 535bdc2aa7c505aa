"""`.csv` against the standard library's reader."""

import csv
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, open_writer, read


def test_pythons_own_reader_reads_it(tmp_path: Path, make_events) -> None:
    events = make_events(1000, start_us=1_700_000_000_000_000)
    with open_writer(tmp_path / "a.csv", width=346, height=260) as writer:
        writer.events(events)
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["t", "x@346", "y@260", "on"]
    assert [tuple(map(int, row.values())) for row in rows] == events.tolist()


@pytest.mark.parametrize("header", ["t_us,x,y,p", "t,x,y,p", "t,x,y,on", "t,x@346,y@260,on\r"])
def test_headers_of_others(header: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"{header}\n5,1,2,1\n")
    recording = read(tmp_path / "a.csv")
    assert recording.events.tolist() == [(5, 1, 2, True)]
    assert (recording.width, recording.height) == ((346, 260) if "@" in header else (2, 3))


def test_a_spreadsheets_line_ends_and_blanks_are_read(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"t_us,x,y,p\r\n5, 1, 2, 1\r\n6,1,2,0")
    assert read(tmp_path / "a.csv").events.tolist() == [(5, 1, 2, True), (6, 1, 2, False)]


@pytest.mark.parametrize("text", ["", "5,1,2,1\n", "x,y,p,t\n1,2,1,5\n"])
def test_another_header_is_named(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(FormatError, match=r"a\.csv, line 1: the header must be 't,x@WIDTH,y@HEIGHT,on'"):
        read(tmp_path / "a.csv")


@pytest.mark.parametrize(
    "bad", ["7,1,2", "7;1;2;1", "0.5,1,2,1", "7,1,2,true", f"{10**30},1,2,1", "7,1,2,1,", ",,,"]
)
def test_the_line_that_is_no_event_is_named(bad: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"t_us,x,y,p\n5,1,2,1\n{bad}\n8,1,2,1\n")
    with pytest.raises(FormatError, match=r"a\.csv, line 3: .*correct the line or take it out"):
        read(tmp_path / "a.csv")


def test_times_that_go_back_are_named(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t_us,x,y,p\n5,1,2,1\n4,1,2,1\n")
    with pytest.raises(FormatError, match=r"event 1 \(t=4 x=1 y=2\): t goes back"):
        read(tmp_path / "a.csv")


def test_faery_reads_it_and_writes_what_is_read(tmp_path: Path, make_events) -> None:
    """faery 0.7 writes the size into the header, and does not read it from there."""
    faery = pytest.importorskip("faery", reason="faery, another reader of CSV, is not installed")
    events = make_events(1000, start_us=1_700_000_000_000_000)
    with open_writer(tmp_path / "a.csv", width=346, height=260) as writer:
        writer.events(events)
    stream = faery.events_stream_from_file(tmp_path / "a.csv", dimensions_fallback=(346, 260))
    theirs = np.concatenate(list(stream))
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        np.testing.assert_array_equal(theirs[their_name], events[name])
    stream.to_file(tmp_path / "theirs.csv")
    recording = read(tmp_path / "theirs.csv")
    np.testing.assert_array_equal(recording.events, events)
    assert (recording.width, recording.height) == (346, 260)
