"""The bytes on docs/reference/packets.md, read by what the page says; Voltcam writes the very same."""

import struct
from dataclasses import replace
from io import BytesIO

import msgpack
import numpy as np
import pytest
from markdown_it import MarkdownIt
from tests.docs.blocks import DOCS

from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import events_packet
from voltcam_client.packet import EVENT, FrameMessage, Packet, encode_frame, encode_packet, pack_message

EVENTS = [(1_000_005, 3, 2, 1), (1_000_009, 3, 1, 0)]
BASE_US = 1_000_000
STAMP_NS = 1_700_000_000_000_000_500
SENT = Packet(
    events=np.array(EVENTS, EVENT), width=346, height=260, seq=7, time_base_ns=1000 * BASE_US,
    stamp_ns=STAMP_NS, parameters_version=1,
)  # fmt: skip
FRAME = FrameMessage(
    image=np.array([[0, 10, 20], [30, 40, 50]], np.uint8),
    seq=3, t_us=BASE_US, stamp_ns=STAMP_NS, parameters_version=1,
)  # fmt: skip
NAMES = (
    "topic", "header", "libcaer", "mono", "evt3", "libcaer_cmp", "websocket", "frame header", "image", "dv",
)  # fmt: skip


@pytest.fixture(scope="module")
def shown() -> dict[str, bytes]:
    """The hex blocks of the page, by what they are."""
    text = (DOCS / "reference" / "packets.md").read_text(encoding="utf-8")
    found = [bytes.fromhex(one.content) for one in MarkdownIt().parse(text) if one.info == "text"]
    return dict(zip(NAMES, found, strict=True))


def event_header(encoding: str) -> dict[str, object]:
    return {
        "header": {"stamp": {"sec": 1_700_000_000, "nanosec": 500}, "frame_id": "voltcam"},
        "height": 260, "width": 346, "seq": 7, "time_base": 1_000_000_000, "encoding": encoding,
        "is_bigendian": False, "parameters_version": 1, "dropped": 0,
    }  # fmt: skip


def libcaer(data: bytes) -> list[tuple[int, ...]]:
    return [(BASE_US + us, a >> 17, a >> 2 & 0x7FFF, a >> 1 & 1) for a, us in struct.iter_unpack("<Ii", data)]


def mono(data: bytes) -> list[tuple[int, ...]]:
    return [
        (BASE_US + (word & 0xFFFFFFFF) // 1000, word >> 32 & 0xFFFF, word >> 48 & 0x7FFF, word >> 63)
        for (word,) in struct.iter_unpack("<Q", data)
    ]


def words(data: bytes, high: int, low: int, line: int, event: int) -> list[tuple[int, ...]]:
    """Events as (time, line, other, polarity)."""
    time_high = time_low = shared = 0
    found = []
    for (word,) in struct.iter_unpack("<H", data):
        code, payload = word >> 12, word & 0xFFF
        if code == high:
            time_high = payload
        elif code == low:
            time_low = payload
        elif code == line:
            shared = payload & 0x7FF
        elif code == event:
            found.append((time_high << 12 | time_low, shared, payload & 0x7FF, payload >> 11))
    return found


def dv(data: bytes) -> list[tuple[int, ...]]:
    """By the offsets of the flatbuffer."""
    stream, following, size, root = struct.unpack_from("<iiII", data)
    assert (stream, following, size, data[16:20]) == (0, len(data) - 8, len(data) - 12, b"EVTS")
    table = 12 + root
    fields = table - struct.unpack_from("<i", data, table)[0]
    field = table + struct.unpack_from("<H", data, fields + 4)[0]
    vector = field + struct.unpack_from("<I", data, field)[0]
    (count,) = struct.unpack_from("<I", data, vector)
    return [struct.unpack_from("<qhhB", data, vector + 4 + 16 * i) for i in range(count)]


def test_the_events_are_read_from_the_page(shown: dict[str, bytes]) -> None:
    assert shown["topic"] == b"events"
    assert msgpack.unpackb(shown["header"]) == event_header("libcaer")
    assert libcaer(shown["libcaer"]) == EVENTS
    assert mono(shown["mono"]) == EVENTS
    assert [(t, x, y, p) for t, y, x, p in words(shown["evt3"], 8, 6, 0, 2)] == EVENTS
    assert [(BASE_US + t, x, y, p) for t, x, y, p in words(shown["libcaer_cmp"], 0, 1, 2, 3)] == EVENTS
    assert dv(shown["dv"]) == EVENTS


def test_the_message_of_websocket_is_read_from_the_page(shown: dict[str, bytes]) -> None:
    unpacker = msgpack.Unpacker(BytesIO(shown["websocket"]))
    assert unpacker.unpack() == event_header("mono")
    assert mono(shown["websocket"][unpacker.tell() :]) == EVENTS


def test_the_frame_is_read_from_the_page(shown: dict[str, bytes]) -> None:
    header = msgpack.unpackb(shown["frame header"])
    assert header == {
        "header": {"stamp": {"sec": 1_700_000_000, "nanosec": 500}, "frame_id": "voltcam"},
        "height": 2, "width": 3, "encoding": "mono8", "is_bigendian": False, "step": 3, "seq": 3,
        "time_base": 1_000_000_000, "parameters_version": 1,
    }  # fmt: skip
    assert list(shown["image"]) == [0, 10, 20, 30, 40, 50]


@pytest.mark.parametrize("encoding", ["libcaer", "mono", "evt3", "libcaer_cmp"])
def test_voltcam_writes_these_events(shown: dict[str, bytes], encoding: str) -> None:
    header, buffer = encode_packet(replace(SENT, encoding=encoding))
    assert buffer == shown[encoding]
    if encoding == "libcaer":
        assert header == shown["header"]
    if encoding == "mono":
        assert pack_message(header, buffer) == shown["websocket"]


def test_voltcam_writes_this_frame_and_this_dv_packet(shown: dict[str, bytes]) -> None:
    assert encode_frame(FRAME) == (shown["frame header"], shown["image"])
    packet = events_packet(SENT.events, PACKET.size)
    PACKET.pack_into(packet, 0, 0, len(packet) - PACKET.size)
    assert bytes(packet) == shown["dv"]
