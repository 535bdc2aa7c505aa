"""What transports carry: a topic and its parts as bytes, encoded once for all who want the same."""

import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import msgpack

from voltcam_client.packet import (
    TOPIC_EVENTS,
    TOPIC_FRAMES,
    TOPIC_STATUS,
    FrameMessage,
    Packet,
    encode_frame,
    encode_packet,
)
from voltcam_client.samples import SamplesMessage, encode_samples

HEADER_BYTES = 300  # about


class Message:
    """Something to send.

    topic: as on the wire. size: about how many bytes it is, before it is encoded. content: a Packet, a
    FrameMessage or a SamplesMessage, for a transport with an encoding of its own.
    """

    def __init__(
        self, topic: bytes, size: int, encode: Callable[[str], tuple[bytes, ...]], content: Any = None
    ) -> None:
        self.topic = topic
        self.size = size
        self.content = content
        self._encode = encode
        self._encoded: dict[str, tuple[bytes, ...]] = {}
        self._lock = threading.Lock()

    def parts(self, encoding: str) -> tuple[bytes, ...]:
        """Header and buffer (status: the header alone); `encoding` matters to events only."""
        with self._lock:
            key = encoding if self.topic == TOPIC_EVENTS else ""
            if key not in self._encoded:
                self._encoded[key] = self._encode(encoding)
            return self._encoded[key]


def events_message(packet: Packet) -> Message:
    return Message(
        TOPIC_EVENTS,
        8 * packet.events.size + HEADER_BYTES,
        lambda encoding: encode_packet(replace(packet, encoding=encoding)),
        packet,
    )


def frame_message(frame: FrameMessage) -> Message:
    return Message(TOPIC_FRAMES, frame.image.size + HEADER_BYTES, lambda _: encode_frame(frame), frame)


def samples_message(topic: bytes, samples: SamplesMessage) -> Message:
    """Of the topic imu or triggers."""
    return Message(topic, samples.samples.nbytes + HEADER_BYTES, lambda _: encode_samples(samples), samples)


def status_message(status: dict[str, Any]) -> Message:
    return Message(TOPIC_STATUS, 4 * HEADER_BYTES, lambda _: (cast(bytes, msgpack.packb(status)),))
