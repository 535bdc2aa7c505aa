"""Readers and writers of a topic that come and go; what they carry is in tests/server."""

import time

import pytest

pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from tests.ros2 import DOMAIN, own_namespace

from voltcam_client.ros2.message_types import COMPRESSED_IMAGE, dds_type
from voltcam_client.ros2.names import Ros2Place
from voltcam_client.ros2.participant import Participant, TopicReader, join

PATIENCE_S = 20.0
AT = 32  # where the one byte of a message is
RELIABLE, BEST_EFFORT = Policy.Reliability.Reliable(0), Policy.Reliability.BestEffort


def message(number: int) -> bytes:
    """sensor_msgs/CompressedImage without frame_id and format, of one byte."""
    text = b"\1\0\0\0\0\0\0\0"
    return b"\0\1\0\0" + bytes(8) + text + text + b"\1\0\0\0" + bytes([number])


@pytest.fixture
def topic() -> str:
    return f"/{own_namespace()}/image_raw/compressed"


@pytest.fixture
def participant() -> Participant:
    return join(Ros2Place(int(DOMAIN)))


def writer(participant: Participant, topic: str, reliability: object) -> DataWriter:
    settings = Qos(reliability, Policy.Durability.Volatile, Policy.History.KeepLast(10))
    return DataWriter(participant.entity, participant.topic(topic, COMPRESSED_IMAGE), settings)


def heard(reader: TopicReader, writer: DataWriter, number: int) -> list[bytes]:
    """Numbers that come until this one does, which is sent again and again."""
    numbers: list[bytes] = []
    until_s = time.monotonic() + PATIENCE_S
    while bytes([number]) not in numbers:
        assert time.monotonic() < until_s, "it is not heard"
        writer.write(dds_type(COMPRESSED_IMAGE)(message(number)))
        numbers += [cdr[AT : AT + 1] for cdr in reader.take(0.02)]
    return numbers


def test_writers_that_leave_and_others_that_come(participant: Participant, topic: str) -> None:
    """Cyclone tells of one that has left as of a message, which is none of the topic's."""
    reader = participant.reader(topic, COMPRESSED_IMAGE)
    for number, reliability in enumerate((RELIABLE, RELIABLE, BEST_EFFORT, RELIABLE, BEST_EFFORT)):
        one = writer(participant, topic, reliability)
        assert bytes([number]) in heard(reader, one, number)
        del one
