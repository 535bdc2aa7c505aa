"""Images of a folder without a list: in the order of their numbers, at given times."""

from pathlib import Path

import pytest

from voltcam_video import SourceError
from voltcam_video.sources.timed_images import Unit, evenly_timed, images_in, timed_by


def folder(path: Path, *names: str) -> Path:
    path.mkdir()
    for name in names:
        (path / name).touch()
    return path


def test_numbers_in_names_are_numbers(tmp_path: Path) -> None:
    here = folder(tmp_path / "in", "10.png", "2.png", "b1.JPG", "a20.jpg", "a3.jpg", "notes.txt")
    assert [path.name for path in images_in(here)] == ["2.png", "10.png", "a3.jpg", "a20.jpg", "b1.JPG"]


def test_an_even_rate_begins_at_0(tmp_path: Path) -> None:
    listed = evenly_timed(folder(tmp_path / "in", *(f"{i}.png" for i in range(4))), 30)
    assert [one.t_us for one in listed] == [0, 33_333, 66_667, 100_000]


@pytest.mark.parametrize(
    ("text", "unit", "t_us"),
    [
        ("# time\n1.5\n\n1.75 more\n", "s", [1_500_000, 1_750_000]),
        ("1511885100.123456789, a\n1511885100.2\n", "s", [1_511_885_100_123_457, 1_511_885_100_200_000]),
        ("10\n20.5", "ms", [10_000, 20_500]),
        ("10\n20", "us", [10, 20]),
        ("10000\n20000", "ns", [10, 20]),
    ],
)
def test_times_stand_at_the_beginning_of_lines(
    tmp_path: Path, text: str, unit: Unit, t_us: list[int]
) -> None:
    here = folder(tmp_path / "in", "0.png", "1.png")
    (tmp_path / "stamps.txt").write_text(text)
    assert [one.t_us for one in timed_by(here, tmp_path / "stamps.txt", unit)] == t_us


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0\n", "has 1 times for 2 images: give one for each"),
        ("0\n1\n2\n", r"has more times than .*in has images \(2\)"),
        ("0\nx\n", "line 2: begins with no number"),
        ("0\nnan\n", "line 2: begins with no number"),
        ("0\n,\n", "line 2: begins with no number"),
        ("1\n1\n", "line 2: not later than the line before"),
    ],
)
def test_wrong_times_name_the_line(tmp_path: Path, text: str, words: str) -> None:
    here = folder(tmp_path / "in", "0.png", "1.png")
    (tmp_path / "stamps.txt").write_text(text)
    with pytest.raises(SourceError, match=words):
        timed_by(here, tmp_path / "stamps.txt", "s")


def test_what_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=r"in: has no image \(\.bmp"):
        images_in(folder(tmp_path / "in"))
    with pytest.raises(SourceError, match="gone: cannot be read"):
        images_in(tmp_path / "gone")
    with pytest.raises(SourceError, match=r"stamps\.txt: cannot be read"):
        timed_by(folder(tmp_path / "new", "0.png"), tmp_path / "stamps.txt", "s")
