"""Topics of ROS 2, on DDS by Cyclone: events, image_raw, camera_info and imu under one namespace.

DDS itself keeps what waits for a reader that is too slow, the newest HISTORY_BYTES of each topic, and sends
it again. It does not tell us what a reader has lost, which sees it in `seq`. Triggers have no message there.
"""

import logging
import time
from collections.abc import Callable
from functools import partial
from typing import ClassVar, NamedTuple

from voltcam_client.formats.ros_messages import EventsAs
from voltcam_client.intrinsics import UNKNOWN_INTRINSICS, Intrinsics
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_client.ros2 import Ros2Error, messages
from voltcam_client.ros2.message_types import CAMERA_INFO, EVENT_ARRAY, EVENTS, IMAGE, IMU
from voltcam_client.ros2.names import Ros2Place, topic_name
from voltcam_client.ros2.participant import TopicWriter, join
from voltcam_client.samples import TOPIC_IMU

from ..messages import Message
from ..problems import UsageError, one_line
from .transport import Transport, TransportStatus

HISTORY_BYTES = 16 * 2**20
MOST_MESSAGES = 1000  # of a topic
TOLD_S = 10.0


def _events(encoding: str, message: Message) -> list[bytes]:
    return [messages.event_packet(message.content, encoding, message.parts(encoding)[1])]


def _event_array(message: Message) -> list[bytes]:
    return [messages.event_array(message.content)]


def _image(message: Message) -> list[bytes]:
    return [messages.image(message.content)]


def _camera_info(intrinsics: Intrinsics, message: Message) -> list[bytes]:
    return [messages.camera_info(message.content, intrinsics)]


def _imu(message: Message) -> list[bytes]:
    return messages.imu(message.content.samples, message.content.frame_id)


class _Kind(NamedTuple):
    """A topic's name and type, and what is made for it of a message."""

    name: str
    type: str
    encode: Callable[[Message], list[bytes]]


class Ros2Transport(Transport):
    """Publishes `NAMESPACE/events` and so on, as the environment of ROS 2 says where. Raises UsageError.

    largest: bytes of the largest message of each topic that there is. events: the type of their messages.
    """

    name: ClassVar[str] = "ros2"

    def __init__(
        self,
        namespace: str,
        encoding: str,
        largest: dict[bytes, int],
        events: EventsAs = "packet",
        intrinsics: Intrinsics = UNKNOWN_INTRINSICS,
    ) -> None:
        super().__init__()
        self._sent = self._lost = 0
        self._told_s = -TOLD_S
        as_events = {
            "packet": _Kind("events", EVENTS, partial(_events, encoding)),
            "array": _Kind("events", EVENT_ARRAY, _event_array),
        }
        kinds = {
            TOPIC_EVENTS: [as_events[events]],
            TOPIC_FRAMES: [
                _Kind("image_raw", IMAGE, _image),
                _Kind("camera_info", CAMERA_INFO, partial(_camera_info, intrinsics)),
            ],
            TOPIC_IMU: [_Kind("imu", IMU, _imu)],
        }
        try:
            self.namespace, place = topic_name(namespace), Ros2Place.of()
            participant = join(place)
            self._topics: dict[bytes, list[tuple[TopicWriter, Callable[[Message], list[bytes]]]]] = {
                topic: [
                    (
                        participant.writer(f"{self.namespace}/{kind.name}", kind.type, _depth(size)),
                        kind.encode,
                    )
                    for kind in kinds[topic]
                ]
                for topic, size in largest.items()
            }
        except Ros2Error as error:
            raise UsageError(f"--ros2 {namespace}: {one_line(error)}") from None
        self._domain = place.domain

    @property
    def status(self) -> TransportStatus:
        return TransportStatus(
            address=f"{self.namespace}, domain {self._domain}",
            packets_sent=self._sent,
            packets_dropped=self._lost,
        )

    def _send(self, message: Message) -> None:
        try:
            for writer, encode in self._topics.get(message.topic, ()):
                if writer.readers:
                    taken = [writer.write(cdr) for cdr in encode(message)]
                    self._count(message, all(taken))
        except Ros2Error as error:  # there are times that ROS 2 has no stamp for
            self._count(message, False)
            self._tell_of(error)

    def _count(self, message: Message, taken: bool) -> None:
        if message.topic == TOPIC_EVENTS:
            self._sent += taken
            self._lost += not taken

    def _dropped(self, message: Message) -> None:
        self._count(message, False)

    def _tell_of(self, error: Ros2Error) -> None:
        if time.monotonic() - self._told_s > TOLD_S:
            self._told_s = time.monotonic()
            logging.getLogger(__name__).warning("%s: %s", self.namespace, error)

    def _close(self) -> None:
        self._topics.clear()


def _depth(largest: int) -> int:
    """How many messages wait for a reader, of such a size."""
    return max(2, min(MOST_MESSAGES, HISTORY_BYTES // largest))
