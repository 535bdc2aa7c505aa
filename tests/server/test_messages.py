"""Messages: encoded when somebody wants them, and once for each who wants the same."""

import time

import msgpack
import numpy as np

from voltcam_client.packet import (
    EVENT,
    TOPIC_EVENTS,
    TOPIC_FRAMES,
    TOPIC_STATUS,
    FrameMessage,
    Packet,
    decode_frame,
    decode_packet,
)
from voltcam_server.messages import HEADER_BYTES, Message, events_message, frame_message, status_message


def packet(count: int = 5) -> Packet:
    events = np.zeros(count, EVENT)
    events["t"], events["x"] = 1000 + np.arange(count), np.arange(count)
    return Packet(
        events=events, width=24, height=16, seq=7, time_base_ns=1_000_000, stamp_ns=time.time_ns(),
        frame_id="tiny", parameters_version=2, dropped=1,
    )  # fmt: skip


def test_events_come_in_the_encoding_that_is_asked_for() -> None:
    message = events_message(packet())
    assert message.topic == TOPIC_EVENTS
    for encoding in ("libcaer", "mono", "evt3"):
        header, buffer = message.parts(encoding)
        decoded = decode_packet(header, buffer)
        assert decoded.encoding == encoding
        np.testing.assert_array_equal(decoded.events, packet().events)
        assert (decoded.seq, decoded.frame_id) == (7, "tiny")


def test_who_wants_the_same_gets_the_same_bytes() -> None:
    asked: list[str] = []

    def encode(encoding: str) -> tuple[bytes, ...]:
        asked.append(encoding)
        return (encoding.encode(),)

    message = Message(TOPIC_EVENTS, 1, encode)
    parts = [message.parts(encoding) for encoding in ("mono", "evt3", "mono", "evt3")]
    assert asked == ["mono", "evt3"]
    assert parts[0] is parts[2]
    frame = Message(TOPIC_FRAMES, 1, encode)
    assert frame.parts("mono") is frame.parts("")  # an encoding is of events
    assert asked == ["mono", "evt3", "mono"]


def test_nothing_is_encoded_before_it_is_wanted() -> None:
    message = Message(TOPIC_STATUS, 1, lambda _: (_ for _ in ()).throw(AssertionError))
    assert message.topic == TOPIC_STATUS


def test_a_frame_is_its_image() -> None:
    image = np.arange(16 * 24, dtype=np.uint8).reshape(16, 24)
    message = frame_message(FrameMessage(image=image, seq=3, t_us=99, stamp_ns=1))
    header, buffer = message.parts("libcaer")
    decoded = decode_frame(header, buffer)
    assert (message.topic, decoded.seq, decoded.t_us) == (TOPIC_FRAMES, 3, 99)
    np.testing.assert_array_equal(decoded.image, image)


def test_a_status_is_msgpack_alone() -> None:
    status = {"state": "running", "load": 0.5, "recording": None}
    (header,) = status_message(status).parts("")
    assert msgpack.unpackb(header) == status


def test_sizes_are_about_what_is_sent() -> None:
    """Outboxes are bounded by them, before anything is encoded."""
    for count in (0, 10_000):
        header, buffer = (message := events_message(packet(count))).parts("libcaer")
        assert abs(len(header) + len(buffer) - message.size) < HEADER_BYTES
    image = np.zeros((480, 640), np.uint8)
    frame = frame_message(FrameMessage(image=image, seq=0, t_us=0, stamp_ns=0))
    assert abs(sum(map(len, frame.parts(""))) - frame.size) < HEADER_BYTES
