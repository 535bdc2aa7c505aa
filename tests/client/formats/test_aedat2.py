"""`.aedat` as jAER and v2e lay it out. tests/interop has tonic's reader beside it."""

from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import FormatError, read

HEADER = b"#!AER-DAT2.0\r\n# This is a raw AE data file - do not edit\r\n"


def records(*pairs: tuple[int, int]) -> bytes:
    return np.array(pairs, ">u4").tobytes()


def davis(x: int, y: int, on: bool) -> int:
    """x from the right, y from below."""
    return y << 22 | x << 12 | on << 11


def test_a_davis346_without_its_name(tmp_path: Path) -> None:
    """With a frame's sample, a trigger, and half a record at the end."""
    body = records((davis(345, 259, True), 5), (1 << 31, 6), (1 << 10, 7), (davis(0, 0, False), 8)) + b"cut"
    (tmp_path / "a.aedat").write_bytes(HEADER + body)
    recording = read(tmp_path / "a.aedat")
    assert recording.events.tolist() == [(5, 0, 0, True), (8, 345, 259, False)]
    assert (recording.width, recording.height) == (346, 260)


def test_the_chip_that_is_named(tmp_path: Path) -> None:
    name = b"# AEChip: eu.seebetter.ini.chips.davis.Davis240C\r\n"
    (tmp_path / "a.aedat").write_bytes(HEADER + name + records((davis(239, 179, True), 5)))
    recording = read(tmp_path / "a.aedat")
    assert recording.events.tolist() == [(5, 0, 0, True)]
    assert (recording.width, recording.height) == (240, 180)


def test_a_dvs128(tmp_path: Path) -> None:
    name = b"# AEChip: ch.unizh.ini.jaer.chip.retina.DVS128\r\n"
    body = records((127 << 8 | 127 << 1, 5), (1 << 15, 6), (2 << 8 | 1 << 1 | 1, 7))
    (tmp_path / "a.aedat").write_bytes(HEADER + name + body)
    recording = read(tmp_path / "a.aedat")
    assert recording.events.tolist() == [(5, 0, 0, True), (7, 126, 125, False)]
    assert (recording.width, recording.height) == (128, 128)


def test_a_clock_that_goes_round_and_events_out_of_order(tmp_path: Path) -> None:
    times = [2**32 - 5, 3, 2, 2**31]
    body = records(*((davis(i, 0, True), t) for i, t in enumerate(times)))
    (tmp_path / "a.aedat").write_bytes(HEADER + body)
    events = read(tmp_path / "a.aedat").events
    assert events["t"].tolist() == [2**32 - 5, 2**32 + 2, 2**32 + 3, 2**32 + 2**31]
    assert events["x"].tolist() == [345, 343, 344, 342]


def test_what_is_no_aedat2(tmp_path: Path) -> None:
    for content, fault in (
        (b"", "no AEDAT 2.0 file"),
        (b"#!AER-DAT3.1\r\n", "no AEDAT 2.0 file"),
        (HEADER + records((davis(346, 0, True), 5)), "outside of 346x260 pixels"),
    ):
        (tmp_path / "a.aedat").write_bytes(content)
        with pytest.raises(FormatError, match=fault):
            read(tmp_path / "a.aedat")
    (tmp_path / "a.aedat").write_bytes(HEADER.rstrip())
    assert read(tmp_path / "a.aedat").events.size == 0
