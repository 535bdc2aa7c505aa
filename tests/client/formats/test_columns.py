"""Events as lines of numbers, in any layout, against Python's own csv module."""

import csv
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError
from voltcam_client.formats.columns import Layout, format_rows, read_events
from voltcam_client.formats.recording import MAX_T_US

TABLE = Layout(columns="t_us,x,y,p", separator=",", seconds=False, header="t_us,x,y,p")
BLANKS = Layout(columns="t x y p", separator=None, seconds=True)

rows = st.lists(
    st.tuples(st.integers(0, MAX_T_US - 1), st.integers(0, 65535), st.integers(0, 65535), st.booleans())
)


def table(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


@settings(deadline=None)  # disks are slow at times
@given(rows)
def test_the_csv_module_writes_what_is_read_and_reads_what_is_written(
    events: list[tuple[int, int, int, bool]],
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        theirs, ours = Path(folder) / "theirs.csv", Path(folder) / "ours.csv"
        with theirs.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["t_us", "x", "y", "p"])
            writer.writerows([t, x, y, int(p)] for t, x, y, p in events)
        read = read_events(theirs, TABLE)
        assert read.dtype == EVENT
        assert read.tolist() == events
        ours.write_bytes(b"t_us,x,y,p\n" + format_rows("%d,%d,%d,%d\n", *(read[name] for name in "txyp")))
        with ours.open(newline="") as file:
            lines = [tuple(map(int, line)) for line in list(csv.reader(file))[1:]]
        assert lines == [(t, x, y, int(p)) for t, x, y, p in events]


def test_no_rows_are_no_bytes() -> None:
    assert format_rows("%d %d\n", np.empty(0, np.int64), np.empty(0, np.int64)) == b""


@pytest.mark.parametrize("text", ["", "# nothing yet\n", "\n\n"])
def test_a_text_without_events_is_empty_and_gives_no_warning(text: str, tmp_path: Path) -> None:
    assert read_events(table(tmp_path / "a", text), BLANKS).size == 0
    assert read_events(table(tmp_path / "a", f"t_us,x,y,p\n{text}"), TABLE).size == 0


@pytest.mark.parametrize("header", ["", "t,x,y,p", "1,2,3,1"])
def test_a_missing_header_is_named(header: str, tmp_path: Path) -> None:
    path = table(tmp_path / "a", f"{header}\n1,2,3,1\n")
    with pytest.raises(FormatError, match="line 1: the header must be 't_us,x,y,p': put it there"):
        read_events(path, TABLE)


@pytest.mark.parametrize(
    ("line", "is_event"),
    [
        (f"{MAX_T_US - 1},65535,65535,1", True),
        (f"{MAX_T_US},0,0,1", False),
        ("0,65536,0,1", False),
        ("0,0,65536,1", False),
        ("-1,0,0,1", False),
        ("0.5,0,0,1", False),
        ("0,0,0,2", False),
        ("0,0,0", False),
        ("0,0,0,1,1", False),
        ("0 0 0 1", False),
    ],
)
def test_the_line_that_is_no_event_is_counted_with_the_header(
    line: str, is_event: bool, tmp_path: Path
) -> None:
    path = table(tmp_path / "a", f"t_us,x,y,p\n0,1,2,1\n\n# note\n{line}\n0,1,2,1\n")
    if is_event:
        assert len(read_events(path, TABLE)) == 3
        return
    with pytest.raises(FormatError, match=r"a, line 5: it is not 't_us,x,y,p'") as error:
        read_events(path, TABLE)
    assert line not in str(error.value)  # who asks may not be allowed to read it


@pytest.mark.parametrize("cut", range(len("12,34,56,1\n") + 1))
def test_a_last_line_that_is_cut_short_is_left_out(cut: int, tmp_path: Path) -> None:
    last = "12,34,56,1\n"[:cut]
    events = read_events(table(tmp_path / "a", f"t_us,x,y,p\n0,1,2,1\n{last}"), TABLE)
    whole = len(last) >= len("12,34,56,1")
    assert events.tolist() == [(0, 1, 2, True), (12, 34, 56, True)][: 1 + whole]


def test_a_last_line_that_no_crash_leaves_is_named(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="is no text of events: give lines 't x y p'"):
        read_events(table(tmp_path / "a", "0.1 2 3 1\nhello"), BLANKS)


def test_the_limit_of_time_is_in_the_unit_of_the_layout(tmp_path: Path) -> None:
    assert (TABLE.t_limit, BLANKS.t_limit) == (MAX_T_US, MAX_T_US // 1_000_000)
    last = read_events(table(tmp_path / "a", "4294967295.999999 0 0 1\n"), BLANKS)
    assert last["t"].tolist() == [MAX_T_US - 1]
