"""The encodings against decoders written out word by word from the formats, and against expelliarmus."""

from pathlib import Path

import numpy as np
import pytest
from expelliarmus import Wizard
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.encodings import ENCODINGS, EVENT, Events, decode_evt3
from voltcam_client.errors import PacketError

EPOCH_US = 1_700_000_000_000_000
SPAN_US = {"libcaer": 2**31, "mono": 4_294_967, "evt3": 16_000_000, "libcaer_cmp": 16_000_000}
LIMITS = {
    "libcaer": (2**15, 2**15),
    "mono": (2**16, 2**15),
    "evt3": (2**11, 2**11),
    "libcaer_cmp": (2**11, 2**11),
}
BOTH = ("evt3", "libcaer_cmp")


def events_of(rows: list[tuple[int, int, int, bool]]) -> Events:
    return np.array(rows, EVENT)


@st.composite
def packets(draw: st.DrawFn) -> tuple[str, int, Events]:
    """An encoding, a time base and events up to the limits of the encoding; equal stamps are frequent."""
    encoding = draw(st.sampled_from(list(ENCODINGS)))
    time_base_us = draw(st.sampled_from([0, 1, 2**24 - 1, EPOCH_US]) | st.integers(0, 2 * EPOCH_US))
    x_limit, y_limit = LIMITS[encoding]
    us = st.sampled_from([0, 1, 4095, 4096, SPAN_US[encoding] - 1]) | st.integers(0, SPAN_US[encoding] - 1)
    x = st.sampled_from([0, 1, x_limit - 1]) | st.integers(0, x_limit - 1)
    y = st.sampled_from([0, 1, y_limit - 1]) | st.integers(0, y_limit - 1)
    rows = draw(st.lists(st.tuples(us, x, y, st.booleans()), max_size=40))
    events = events_of(sorted(rows, key=lambda row: row[0]))
    events["t"] += time_base_us
    return encoding, time_base_us, events


@given(packets())
def test_events_come_back_as_they_were(packet: tuple[str, int, Events]) -> None:
    encoding, time_base_us, events = packet
    buffer = ENCODINGS[encoding].encode(events, time_base_us)
    np.testing.assert_array_equal(ENCODINGS[encoding].decode(buffer, time_base_us), events)


@given(packets())
def test_a_literal_decoder_reads_the_same_events(packet: tuple[str, int, Events]) -> None:
    encoding, time_base_us, events = packet
    buffer = ENCODINGS[encoding].encode(events, time_base_us)
    assert LITERAL[encoding](buffer, time_base_us) == events.tolist()


word_streams = st.lists(
    # Mostly codes that mean something in both formats, and payloads that hit the edges.
    st.tuples(
        st.integers(0, 15) | st.integers(0, 8),
        st.sampled_from([0, 1, 0x7FF, 0x800, 0xFFF]) | st.integers(0, 0xFFF),
    ),
    max_size=60,
)


@given(st.sampled_from(BOTH), word_streams, st.sampled_from([0, EPOCH_US]))
def test_any_words_decode_as_the_literal_decoder_says(
    encoding: str, stream: list[tuple[int, int]], time_base_us: int
) -> None:
    buffer = np.array([code << 12 | payload for code, payload in stream], "<u2").tobytes()
    assert ENCODINGS[encoding].decode(buffer, time_base_us).tolist() == LITERAL[encoding](
        buffer, time_base_us
    )


@given(st.lists(st.integers(0, 2**31 - 1), max_size=20).map(sorted), st.integers(0, 20))
def test_libcaer_follows_a_roll_over_within_a_packet(us: list[int], cut: int) -> None:
    """The sensor's 31-bit clock starts again inside a packet: a real DAVIS does this every 36 minutes."""
    rolled = us[cut:] + us[:cut]
    words = np.zeros((len(rolled), 2), "<u4")
    words[:, 1] = rolled
    buffer = words.tobytes()
    assert ENCODINGS["libcaer"].decode(buffer, 7).tolist() == literal_libcaer(buffer, 7)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_packet_decodes_alone(encoding: str) -> None:
    """The second half of a recording, without the first, and the 24-bit clock turning over inside it."""
    base_us = EPOCH_US - EPOCH_US % 2**24 + 2**24
    events = events_of([(base_us + dt, 3, 5, dt > 0) for dt in (-4097, -4096, -1, 0, 0, 1, 4096, 1_000_000)])
    late = events[2:]
    time_base_us = int(late["t"][0]) - 100
    buffer = ENCODINGS[encoding].encode(late, time_base_us)
    np.testing.assert_array_equal(ENCODINGS[encoding].decode(buffer, time_base_us), late)


def test_libcaer_bytes_are_those_of_the_format() -> None:
    buffer = ENCODINGS["libcaer"].encode(events_of([(1_000_258, 3, 2, True)]), 1_000_000)
    assert buffer == (3 << 17 | 2 << 2 | 1 << 1 | 1).to_bytes(4, "little") + (258).to_bytes(4, "little")


def test_mono_bytes_are_those_of_the_format() -> None:
    buffer = ENCODINGS["mono"].encode(events_of([(1_000_258, 3, 2, True)]), 1_000_000)
    assert buffer == (1 << 63 | 2 << 48 | 3 << 32 | 258_000).to_bytes(8, "little")


def test_evt3_starts_with_the_time_even_when_empty() -> None:
    words = np.frombuffer(ENCODINGS["evt3"].encode(np.empty(0, EVENT), 0x123456), "<u2").tolist()
    assert words == [0x8123, 0x6456]


@pytest.mark.parametrize("encoding", BOTH)
def test_words_are_left_out_where_nothing_changes(encoding: str) -> None:
    """A row (evt3) or column (libcaer_cmp) of events at one time costs 2 bytes each."""
    at = np.arange(1000)
    events = np.zeros(1000, EVENT)
    events["x" if encoding == "evt3" else "y"] = at
    assert len(ENCODINGS[encoding].encode(events, 0)) <= 2 * (1000 + 4)


def random_events(n: int, span_us: int) -> Events:
    rng = np.random.default_rng(1)
    events = np.empty(n, EVENT)
    events["t"] = 5_000_000 + np.sort(rng.integers(0, span_us, n))
    events["x"], events["y"], events["p"] = (
        rng.integers(0, 346, n),
        rng.integers(0, 260, n),
        rng.random(n) < 0.5,
    )
    return events


def expelliarmus(path: Path, words: bytes) -> np.ndarray:
    path.write_bytes(b"% evt 3.0\n% geometry 346x260\n" + words)
    return Wizard(encoding="evt3").read(path)


def test_expelliarmus_reads_our_evt3(tmp_path: Path) -> None:
    events = random_events(5000, span_us=4096 - 5_000_000 % 4096)
    theirs = expelliarmus(tmp_path / "ours.raw", ENCODINGS["evt3"].encode(events, 5_000_000))
    for field in "txyp":
        np.testing.assert_array_equal(theirs[field], events[field])


def test_expelliarmus_reads_many_packets_in_a_row(tmp_path: Path) -> None:
    events = random_events(20_000, span_us=2_000_000)
    words = b"".join(ENCODINGS["evt3"].encode(part, int(part["t"][0])) for part in np.split(events, 20))
    theirs = expelliarmus(tmp_path / "ours.raw", words)
    for field in "xyp":
        np.testing.assert_array_equal(theirs[field], events[field])
    # expelliarmus 1.1.12 takes a time low that falls for a carry of its own, although time high has it too
    # (its evt3.c, EVT3_TIME_LOW): it is 4096 us ahead after each.
    carries = np.cumsum(np.diff(events["t"] & 0xFFF, prepend=0) < 0)
    np.testing.assert_array_equal(theirs["t"] - 4096 * carries, events["t"])


def test_vectors_decode_as_expelliarmus_reads_them(tmp_path: Path) -> None:
    """Prophesee sensors send runs of a row as bit masks: base 100, 12 + 12 + 8 pixels, another base."""
    words = [0x8001, 0x6005, 0x0007, 0x3864, 0x4FFF, 0x4801, 0x5081, 0x2003, 0x3000, 0x5003, 0x6006, 0x4002]
    buffer = np.array(words, "<u2").tobytes()
    theirs = expelliarmus(tmp_path / "vectors.raw", buffer)
    ours = decode_evt3(buffer, 0)
    assert ours.size == 12 + 2 + 2 + 1 + 2 + 1
    for field in "txyp":
        np.testing.assert_array_equal(ours[field], theirs[field])


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_limits_are_named(encoding: str) -> None:
    encode = ENCODINGS[encoding].encode
    x_limit, y_limit = LIMITS[encoding]
    span_us = SPAN_US[encoding]
    encode(events_of([(0, x_limit - 1, y_limit - 1, True), (span_us - 1, 0, 0, True)]), 0)
    if x_limit < 2**16:
        with pytest.raises(PacketError, match=f"{encoding} holds x below {x_limit}"):
            encode(events_of([(0, x_limit, 0, True)]), 0)
    with pytest.raises(PacketError, match=f"y below {y_limit}"):
        encode(events_of([(0, 0, y_limit, True)]), 0)
    with pytest.raises(PacketError, match="smaller packets"):
        encode(events_of([(span_us, 0, 0, True)]), 0)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("times", [[3, 2], [-1], [5, 5, 4]])
def test_events_out_of_order_are_refused(encoding: str, times: list[int]) -> None:
    with pytest.raises(PacketError, match="sorted"):
        ENCODINGS[encoding].encode(events_of([(t, 0, 0, True) for t in times]), 0)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_buffer_cut_inside_a_word_is_refused(encoding: str) -> None:
    buffer = ENCODINGS[encoding].encode(events_of([(0, 1, 2, True)]), 0)
    with pytest.raises(PacketError, match="cut short"):
        ENCODINGS[encoding].decode(buffer[:-1], 0)


# --- decoders as literal as the formats' descriptions, one word at a time ---

Row = tuple[int, int, int, bool]


def literal_libcaer(buffer: bytes, time_base_us: int) -> list[Row]:
    rows, high_us, last_us = [], 0, 0
    for at in range(0, len(buffer), 8):
        data = int.from_bytes(buffer[at : at + 4], "little")
        us = int.from_bytes(buffer[at + 4 : at + 8], "little", signed=True)
        if us < last_us:
            high_us += 2**31
        last_us = us
        rows.append(
            (time_base_us + high_us + us, data >> 17 & 0x7FFF, data >> 2 & 0x7FFF, bool(data >> 1 & 1))
        )
    return rows


def literal_mono(buffer: bytes, time_base_us: int) -> list[Row]:
    rows = []
    for at in range(0, len(buffer), 8):
        word = int.from_bytes(buffer[at : at + 8], "little")
        t_ns = 1000 * time_base_us + (word & 0xFFFFFFFF)
        rows.append((t_ns // 1000, word >> 32 & 0xFFFF, word >> 48 & 0x7FFF, bool(word >> 63)))
    return rows


def literal_evt3(buffer: bytes, time_base_us: int) -> list[Row]:
    rows: list[Row] = []
    high, low, y, base, polarity = time_base_us >> 12, time_base_us & 0xFFF, 0, 0, False
    for at in range(0, len(buffer), 2):
        word = int.from_bytes(buffer[at : at + 2], "little")
        code, rest = word >> 12, word & 0xFFF
        t_us = high << 12 | low
        if code == 0b1000:
            last = high & 0xFFF
            if rest < last and last - rest > 10:
                high += 1 << 12
            high = high & ~0xFFF | rest
        elif code == 0b0110:
            low = rest
        elif code == 0b0000:
            y = rest & 0x7FF
        elif code == 0b0010:
            rows.append((t_us, rest & 0x7FF, y, bool(rest >> 11)))
        elif code == 0b0011:
            base, polarity = rest & 0x7FF, bool(rest >> 11)
        elif code in (0b0100, 0b0101):
            width = 12 if code == 0b0100 else 8
            rows += [(t_us, base + i, y, polarity) for i in range(width) if rest >> i & 1]
            base += width
    return rows


def literal_libcaer_cmp(buffer: bytes, time_base_us: int) -> list[Row]:
    rows: list[Row] = []
    high, low, x, base, polarity = 0, 0, 0, 0, False
    for at in range(0, len(buffer), 2):
        word = int.from_bytes(buffer[at : at + 2], "little")
        code, rest = word >> 12, word & 0xFFF
        t_us = time_base_us + (high << 12 | low)
        if code == 0:
            # ROS does not count turns of the clock here; we do, by the rule of evt3.
            last = high & 0xFFF
            high = (high & ~0xFFF) + ((1 << 12) if last - rest > 10 else 0) | rest
        elif code == 1:
            low = rest
        elif code == 2:
            x = rest & 0x7FF
        elif code == 3:
            rows.append((t_us, x, rest & 0x7FF, bool(rest >> 11)))
        elif code == 4:
            base, polarity = rest & 0x7FF, bool(rest >> 11)
        elif code == 5:
            rows += [(t_us, x, base + i, polarity) for i in range(8) if rest >> i & 1]
            base += 8
    return rows


LITERAL = {
    "libcaer": literal_libcaer,
    "mono": literal_mono,
    "evt3": literal_evt3,
    "libcaer_cmp": literal_libcaer_cmp,
}
