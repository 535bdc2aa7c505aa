"""Headers and messages."""

from typing import Any

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.errors import PacketError
from voltcam_client.packet import (
    EVENT,
    FrameMessage,
    Packet,
    decode_frame,
    decode_message,
    decode_packet,
    encode_frame,
    encode_packet,
    pack_message,
    unpack_message,
)

EVENTS = np.array([(1_700_000_000_000_005, 3, 2, True), (1_700_000_000_000_900, 345, 259, False)], EVENT)


def packet_of(**fields: object) -> Packet:
    given = {
        "events": EVENTS,
        "height": 260,
        "width": 346,
        "seq": 2**40,
        "time_base_ns": 1_700_000_000_000_000_000,
        "stamp_ns": 1_750_000_000_123_456_789,
        "frame_id": "left",
        "encoding": "libcaer",
        "parameters_version": 12,
        "dropped": 34,
    }
    return Packet(**(given | fields))  # type: ignore[arg-type]


def assert_equal(one: Packet, other: Packet) -> None:
    np.testing.assert_array_equal(one.events, other.events)
    for name in Packet.__slots__:
        if name != "events":
            assert getattr(one, name) == getattr(other, name), name


@pytest.mark.parametrize("encoding", ["libcaer", "mono", "evt3", "libcaer_cmp"])
def test_a_packet_comes_back_as_it_was(encoding: str) -> None:
    packet = packet_of(encoding=encoding)
    assert_equal(decode_packet(*encode_packet(packet)), packet)


def test_the_header_has_the_fields_of_ros_event_packet() -> None:
    header, _ = encode_packet(packet_of())
    assert msgpack.unpackb(header) == {
        "header": {"stamp": {"sec": 1_750_000_000, "nanosec": 123_456_789}, "frame_id": "left"},
        "height": 260,
        "width": 346,
        "seq": 2**40,
        "time_base": 1_700_000_000_000_000_000,
        "encoding": "libcaer",
        "is_bigendian": False,
        "parameters_version": 12,
        "dropped": 34,
    }


def test_an_unknown_header_field_is_no_error() -> None:
    """A newer daemon may say more."""
    header, buffer = encode_packet(packet_of())
    newer: Any = msgpack.packb(msgpack.unpackb(header) | {"temperature_c": 40})
    assert_equal(decode_packet(newer, buffer), packet_of())


@given(st.binary(max_size=200), st.text(max_size=100))
def test_a_websocket_message_splits_where_its_header_ends(buffer: bytes, frame_id: str) -> None:
    header, _ = encode_packet(packet_of(frame_id=frame_id))
    assert tuple(map(bytes, unpack_message(pack_message(header, buffer)))) == (header, buffer)


def test_a_websocket_message_is_a_packet() -> None:
    assert_equal(decode_message(pack_message(*encode_packet(packet_of()))), packet_of())


def test_a_message_larger_than_a_read_buffer_is_a_packet() -> None:
    events = np.zeros(3_000_000, EVENT)
    packet = decode_message(pack_message(*encode_packet(packet_of(events=events, time_base_ns=0))))
    assert packet.events.size == 3_000_000


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"encoding": "evt4"}, "unknown encoding 'evt4'.*libcaer, mono, evt3, libcaer_cmp"),
        ({"time_base_ns": 1_700_000_000_000_000_001}, "whole number of us"),
        ({"time_base_ns": -1000}, "0 or more"),
        ({"encoding": "mono", "time_base_ns": 0}, "smaller packets"),
    ],
)
def test_what_cannot_be_sent_is_refused(change: dict[str, object], said: str) -> None:
    with pytest.raises(PacketError, match=said) as caught:
        encode_packet(packet_of(**change))
    assert "\n" not in str(caught.value)


def without(field: str) -> bytes:
    header = msgpack.unpackb(encode_packet(packet_of())[0])
    del header[field]
    return msgpack.packb(header)  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    "header",
    [
        b"",
        b"\xc1",
        b"hello world",
        msgpack.packb([1, 2]),
        msgpack.packb("text"),
        *map(without, ("header", "seq", "time_base", "encoding", "width")),
        msgpack.packb(msgpack.unpackb(encode_packet(packet_of())[0]) | {"time_base": "late"}),
        msgpack.packb(msgpack.unpackb(encode_packet(packet_of())[0]) | {"header": None}),
        msgpack.packb(msgpack.unpackb(encode_packet(packet_of())[0]) | {"encoding": "evt4"}),
        msgpack.packb(msgpack.unpackb(encode_packet(packet_of())[0]) | {"is_bigendian": True}),
    ],
)
def test_bytes_that_are_no_packet_are_refused_in_one_line(header: bytes) -> None:
    with pytest.raises(PacketError) as caught:
        decode_packet(header, b"")
    assert "\n" not in str(caught.value)


@given(st.binary(max_size=100))
def test_any_bytes_are_a_message_or_a_packet_error(message: bytes) -> None:
    with pytest.raises(PacketError):
        decode_message(message)


def test_a_frame_comes_back_as_it_was() -> None:
    image = np.arange(12, dtype=np.uint8).reshape(3, 4)
    frame = FrameMessage(image=image, seq=5, t_us=1_700_000_000_000_001, stamp_ns=9, parameters_version=2)
    header, buffer = encode_frame(frame)
    fields = {"header", "height", "width", "encoding", "is_bigendian", "step"}  # of sensor_msgs/Image
    assert fields <= msgpack.unpackb(header).keys()
    back = decode_frame(*unpack_message(pack_message(header, buffer)))
    np.testing.assert_array_equal(back.image, image)
    assert (back.seq, back.t_us, back.stamp_ns, back.parameters_version) == (5, frame.t_us, 9, 2)


@pytest.mark.parametrize("gamma", [1.0, 2.2])
def test_a_frame_says_whether_it_is_light(gamma: float) -> None:
    """Without a word it is: so say daemons from before."""
    image = np.zeros((3, 4), np.uint8)
    header, buffer = encode_frame(FrameMessage(image=image, seq=0, t_us=0, stamp_ns=0, gamma=gamma))
    assert ("gamma" in msgpack.unpackb(header)) == (gamma != 1)
    assert decode_frame(header, buffer).gamma == gamma


def test_a_frame_may_be_a_part_of_an_image() -> None:
    image = np.arange(100, dtype=np.uint8).reshape(10, 10)[2:5, 1:9:2]
    back = decode_frame(*encode_frame(FrameMessage(image=image, seq=0, t_us=0, stamp_ns=0)))
    np.testing.assert_array_equal(back.image, image)


@pytest.mark.parametrize("change", [{"step": 3}, {"height": 4}, {"encoding": "rgb8"}, {"seq": None}])
def test_a_frame_that_does_not_fit_its_header_is_refused(change: dict[str, object]) -> None:
    header, buffer = encode_frame(FrameMessage(image=np.zeros((3, 4), np.uint8), seq=0, t_us=0, stamp_ns=0))
    fields = msgpack.unpackb(header) | change
    if fields["seq"] is None:
        del fields["seq"]
    changed: Any = msgpack.packb(fields)
    with pytest.raises(PacketError):
        decode_frame(changed, buffer)
