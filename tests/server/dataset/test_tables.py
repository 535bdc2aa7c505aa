"""Tables beside frames: with their times, refused where they do not match."""

from pathlib import Path

import pytest

from voltcam_server.dataset.labels import BesideError
from voltcam_server.dataset.tables import check_table, write_table

TAKEN_US = (0, 10_000, 20_000)


def test_a_time_of_its_own_stays_where_it_is(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("x, t_us\n1,0\n2,15000\n3,20001\n")
    check_table(tmp_path / "in.csv", 3)
    assert write_table(tmp_path / "in.csv", tmp_path / "out.csv", TAKEN_US) == 2
    assert (tmp_path / "out.csv").read_text() == "x,t_us\n1,0\n2,15000\n"


def test_a_frame_gets_its_time(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text('frame,what\n0,"a, b"\n\n2,c\n3,late\n')
    assert write_table(tmp_path / "in.csv", tmp_path / "out.csv", TAKEN_US) == 2
    assert (tmp_path / "out.csv").read_text() == 't_us,frame,what\n0,0,"a, b"\n20000,2,c\n'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no column t_us or frame"),
        ("time,x\n0,1\n", "has no column t_us or frame, only time, x"),
        ("frame\n0\n3\n", "line 3: frame 3 of 3: frames count from 0"),
        ("frame\nfirst\n", "line 2: its time is no whole number"),
        ("x,frame\n1\n", "line 2: its time is no whole number"),
        ("t_us\n-1\n", "line 2: its time is -1; give 0 or more"),
    ],
)
def test_what_does_not_match_is_said(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "in.csv").write_text(text)
    with pytest.raises(BesideError, match=words):
        check_table(tmp_path / "in.csv", 3)
    with pytest.raises(BesideError, match="cannot be read as CSV"):
        check_table(tmp_path / "gone.csv", 3)
