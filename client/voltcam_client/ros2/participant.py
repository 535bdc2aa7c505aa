"""This process among the programs of ROS 2: writers and readers of their topics, of packed CDR.

Sources: OMG DDS 1.4, 2.2.3 (quality of service); Eclipse Cyclone DDS' configuration guide.
"""

import threading
from typing import Any

from voltcam_client.pushed_frame import MOST_BYTES
from voltcam_client.ros2 import Ros2Error
from voltcam_client.ros2.message_types import HASHES, PackedMessage, dds_type, library
from voltcam_client.ros2.names import Ros2Place, dds_name

MOST_PARTICIPANTS = 100  # of a domain on one machine: each has a port of its own
MOST_SAMPLE_BYTES = MOST_BYTES + (1 << 16)
# A writer's history is what bounds the messages that wait for its readers. Cyclone's own bound would hold up
# the writer, and with it all other readers.
WAITING_BYTES = 1 << 30
THIS_MACHINE = f"""
  <General>
    <Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
    <MaxMessageSize>65000B</MaxMessageSize><FragmentSize>63000B</FragmentSize>
  </General>
  <Discovery>
    <ParticipantIndex>auto</ParticipantIndex>
    <MaxAutoParticipantIndex>{MOST_PARTICIPANTS}</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers>
  </Discovery>"""
LIMITS = f"""
  <Internal>
    <SocketReceiveBufferSize max="4MB"/>
    <MaxSampleSize>{MOST_SAMPLE_BYTES}B</MaxSampleSize>
    <Watermarks><WhcHigh>{WAITING_BYTES}B</WhcHigh></Watermarks>
  </Internal>
  <Tracing><Verbosity>severe</Verbosity></Tracing>"""

_lock = threading.Lock()
_joined: dict[Ros2Place, "Participant"] = {}


def join(place: Ros2Place) -> "Participant":
    """The participant of this process there, which stays to its end. Raises Ros2Error."""
    with _lock:
        if place not in _joined:
            _joined[place] = Participant(place)
        return _joined[place]


class Participant:
    """Made by `join`. Raises Ros2Error."""

    def __init__(self, place: Ros2Place) -> None:
        domain, core = library("domain"), library("core")
        inner = LIMITS if place.subnet else THIS_MACHINE + LIMITS
        try:
            self._domain = domain.Domain(
                place.domain, f'<CycloneDDS><Domain Id="any">{inner}</Domain></CycloneDDS>'
            )
            self.entity = domain.DomainParticipant(place.domain)
        except core.DDSException as error:
            raise Ros2Error(
                f"ROS 2's domain {place.domain} cannot be joined ({error}): set another ROS_DOMAIN_ID"
            ) from None

    def writer(self, topic: str, kind: str, depth: int) -> "TopicWriter":
        """Of a topic's messages of this type. depth: messages that wait for readers. Raises Ros2Error."""
        return TopicWriter(self, topic, kind, depth)

    def topic(self, name: str, kind: str) -> Any:
        """Cyclone's own. Raises Ros2Error."""
        return library("topic").Topic(self.entity, dds_name(name), dds_type(kind))


class TopicWriter:
    """Reliable for readers that ask for it; the oldest message that waits for one of them gives way.

    One thread at a time. It is given back when nobody holds it.
    """

    def __init__(self, participant: Participant, topic: str, kind: str, depth: int) -> None:
        qos = library("qos")
        policy = qos.Policy
        self._kind, self._participant = dds_type(kind), participant
        self._error = library("core").DDSException
        self._writer = library("pub").DataWriter(
            participant.entity,
            participant.topic(topic, kind),
            qos.Qos(
                policy.Reliability.Reliable(max_blocking_time=0),
                policy.Durability.Volatile,
                policy.History.KeepLast(depth),
                policy.Userdata(f"typehash=RIHS01_{HASHES[kind]};".encode()),
            ),
        )

    @property
    def wanted(self) -> bool:
        """Whether somebody reads."""
        return bool(self._writer.get_publication_matched_status().current_count)

    def write(self, cdr: bytes) -> bool:
        """Whether it was taken; it is not where there is no room for it."""
        sample: PackedMessage = self._kind(cdr)
        try:
            self._writer.write(sample)
        except self._error as error:
            if error.code in (self._error.DDS_RETCODE_TIMEOUT, self._error.DDS_RETCODE_OUT_OF_RESOURCES):
                return False
            raise
        return True
