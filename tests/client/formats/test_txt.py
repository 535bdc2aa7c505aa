"""`.txt` and the Event Camera Dataset's folder, against plain Python."""

import tempfile
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.formats import FormatError, open_writer, read
from voltcam_client.packet import EVENT

PNG_2X1 = bytes.fromhex("89504e470d0a1a0a0000000d494844520000000200000001")  # as far as the size


def test_the_text_is_what_the_dataset_has(tmp_path: Path) -> None:
    events = np.array([(3811, 96, 133, False), (1_700_000_000_000_001, 345, 0, True)], EVENT)
    with open_writer(tmp_path / "a.txt", width=346, height=260) as writer:
        writer.events(events)
    assert (tmp_path / "a.txt").read_bytes() == b"0.003811 96 133 0\n1700000000.000001 345 0 1\n"


@settings(deadline=None)  # disks are slow at times
@given(times=st.lists(st.integers(0, 2**32 * 10**6 - 1), min_size=1))
def test_every_microsecond_survives(times: list[int]) -> None:
    events = np.zeros(len(times), EVENT)
    events["t"] = sorted(times)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.txt"
        with open_writer(path, width=1, height=1) as writer:
            writer.events(events)
        written = [int(Decimal(line.split()[0]) * 10**6) for line in path.read_text().splitlines()]
        assert written == sorted(times)
        assert read(path).events["t"].tolist() == written


@pytest.mark.parametrize(
    ("text", "t_us"),
    [
        ("0.003820001 1 2 1\n", 3820),
        ("0.003836999 1 2 1\n", 3837),
        ("1468940293.955124000 1 2 1\n", 1_468_940_293_955_124),
        ("3 1 2 1\n", 3_000_000),
        ("1.5e-3\t1  2 1", 1500),
        ("# t x y p\n\n0.5 1 2 1\r\n", 500_000),
    ],
)
def test_other_ways_to_write_an_event(text: str, t_us: int, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(text.encode())
    assert read(tmp_path / "a.txt").events.tolist() == [(t_us, 1, 2, True)]


@pytest.mark.parametrize(
    "bad",
    [
        "0.2 1 2",
        "0.2 1 2 1 9",
        "zero 1 2 1",
        "0.2 1.5 2 1",
        "0.2 -1 2 1",
        "0.2 1 65536 1",
        "0.2 1 2 2",
        "nan 1 2 1",
        "inf 1 2 1",
        "1e305 1 2 1",
        "-0.2 1 2 1",
        "4294967296 1 2 1",
        "\x00\xff",
    ],
)
def test_the_line_that_is_no_event_is_named(bad: str, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text(f"# comment\n0.1 1 2 0\n\n{bad}\n0.3 1 2 1\n", encoding="latin-1")
    with pytest.raises(FormatError, match=r"a\.txt, line 4: ") as error:
        read(tmp_path / "a.txt")
    assert "\n" not in str(error.value)


def test_times_that_go_back_are_named(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("0.1 1 2 0\n0.3 1 2 0\n0.2 4 5 1\n")
    with pytest.raises(FormatError, match=r"event 2 \(t=200000 x=4 y=5\): t goes back: sort"):
        read(tmp_path / "a.txt")


def test_a_folder_with_images(tmp_path: Path) -> None:
    (tmp_path / "events.txt").write_text("0.1 1 0 1\n")
    (tmp_path / "images.txt").write_text("0.000000000 images/a.png\n0.038766001 images/b c.png\n")
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "a.png").write_bytes(PNG_2X1)
    recording = read(tmp_path)
    assert recording.events.tolist() == [(100_000, 1, 0, True)]
    assert (recording.width, recording.height) == (2, 1)
    assert recording.image_paths == (tmp_path / "images" / "a.png", tmp_path / "images" / "b c.png")
    assert recording.frame_t_us is not None
    assert recording.frame_t_us.tolist() == [0, 38766]
    assert recording.frames is None


@pytest.mark.parametrize("image", [None, b"\xff\xd8 a jpeg", PNG_2X1[:20]])
def test_a_folder_without_a_readable_image(image: bytes | None, tmp_path: Path) -> None:
    (tmp_path / "events.txt").write_text("0.1 5 6 1\n")
    (tmp_path / "images.txt").write_text("0.0 a.png\n")
    if image is not None:
        (tmp_path / "a.png").write_bytes(image)
    recording = read(tmp_path)
    assert (recording.width, recording.height) == (6, 7)


@pytest.mark.parametrize("bad", ["a.png", "zero a.png", "inf a.png", "0.5"])
def test_the_image_that_is_none_is_named(bad: str, tmp_path: Path) -> None:
    (tmp_path / "events.txt").touch()
    (tmp_path / "images.txt").write_text(f"# list\n0.1 a.png\n{bad}\n")
    with pytest.raises(FormatError, match=r"images\.txt, line 3: "):
        read(tmp_path)


def test_a_recording_of_the_dataset(slider_depth: Path, tmp_path: Path) -> None:
    recording = read(slider_depth)
    assert (recording.width, recording.height) == (240, 180)
    assert len(recording.image_paths) == 87
    assert all(path.exists() for path in recording.image_paths)
    with (slider_depth / "events.txt").open() as lines:
        expected = [
            (round(Decimal(t) * 10**6), int(x), int(y), p == "1")
            for t, x, y, p in (line.split() for line in lines)
        ]
    assert recording.events.tolist() == expected
    assert len(expected) == 1_078_541

    with open_writer(tmp_path / "a.txt", width=240, height=180) as writer:
        writer.events(recording.events)
    np.testing.assert_array_equal(read(tmp_path / "a.txt").events, recording.events)
