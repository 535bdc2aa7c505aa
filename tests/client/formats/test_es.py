"""`.es` against faery, and against the format read byte by byte."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.encodings import EVENT
from voltcam_client.formats import FormatError, open_writer, read

HEADER = b"Event Stream\x02\x00\x00\x01" + np.array([346, 260], "<u2").tobytes()


def byte_by_byte(data: bytes) -> list[tuple[int, int, int, bool]]:
    """The events, as the format's state machine has them."""
    events, t_us, at = [], 0, 0
    while at < len(data):
        if data[at] >= 0xFE:
            t_us += 127 if data[at] == 0xFF else 0
            at += 1
            continue
        t_us += data[at] >> 1
        if at + 5 <= len(data):
            x, y = data[at + 1] | data[at + 2] << 8, data[at + 3] | data[at + 4] << 8
            events.append((t_us, x, 259 - y, bool(data[at] & 1)))
        at += 5
    return events


def test_the_bytes(tmp_path: Path) -> None:
    with open_writer(tmp_path / "a.es", width=346, height=260) as writer:
        writer.events(np.array([(126, 1, 259, True), (126 + 254, 345, 0, False)], EVENT))
    events = bytes([126 << 1 | 1, 1, 0, 0, 0, 0xFF, 0xFF, 0, 345 & 0xFF, 1, 259 & 0xFF, 1])
    assert (tmp_path / "a.es").read_bytes() == HEADER + events


@settings(deadline=None)  # disks are slow at times
@given(
    st.lists(
        st.one_of(
            st.sampled_from([b"\xff", b"\xfe", b"\xff" * 7]),
            st.builds(
                lambda head, x, y: bytes([head, x & 0xFF, x >> 8, y & 0xFF, y >> 8]),
                st.integers(0, 0xFD), st.integers(0, 345), st.integers(0, 259),
            ),
        ),
        max_size=60,
    ),
    st.integers(0, 4),
)  # fmt: skip
def test_the_chain_is_followed_as_byte_by_byte(parts: list[bytes], cut: int) -> None:
    data = b"".join(parts)
    data = data[: len(data) - cut]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.es"
        path.write_bytes(HEADER + data)
        recording = read(path)
    assert recording.events.tolist() == byte_by_byte(data)
    assert (recording.width, recording.height) == (346, 260)


def test_faery_reads_it_and_writes_what_is_read(tmp_path: Path, make_events) -> None:
    faery = pytest.importorskip("faery", reason="faery, another reader of Event Stream, is not installed")
    events = make_events(5000)
    with open_writer(tmp_path / "a.es", width=346, height=260) as writer:
        for packet in np.array_split(events, 7):
            writer.events(packet)
    stream = faery.events_stream_from_file(tmp_path / "a.es")
    theirs = np.concatenate(list(stream))
    assert stream.dimensions() == (346, 260)
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        np.testing.assert_array_equal(theirs[their_name], events[name])
    faery.events_stream_from_array(theirs, (346, 260)).to_file(tmp_path / "theirs.es")
    events["t"] -= events["t"][0]  # where faery has the file begin
    np.testing.assert_array_equal(read(tmp_path / "theirs.es").events, events)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"", "does not begin"),
        (HEADER[:19], "does not begin"),
        (b"Event Stream\x02\x00\x00\x02" + bytes(4), "no DVS events"),
        (b"Event Stream\x01\x00\x00\x01" + bytes(4), "no DVS events"),
        (HEADER + bytes([0, 1, 0, 4, 1]), "outside a height of 260"),
    ],
)
def test_what_is_no_event_stream(content: bytes, fault: str, tmp_path: Path) -> None:
    (tmp_path / "a.es").write_bytes(content)
    with pytest.raises(FormatError, match=fault) as error:
        read(tmp_path / "a.es")
    assert "\n" not in str(error.value)
