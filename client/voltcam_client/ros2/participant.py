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
READER_MESSAGES = 16  # that wait until they are taken: DDS does not say how many it left out for newer ones
MOST_SAMPLE_BYTES = MOST_BYTES + (1 << 16)
# A writer's history is what bounds the messages that wait for its readers. Cyclone's own bound would hold up
# the writer, and with it all other readers.
WAITING_BYTES = 1 << 30
# A program that is started later calls by multicast, which the loopback has not: we call, each second. Ports
# where nobody answers are otherwise given up after 30 s.
THIS_MACHINE = f"""
  <General>
    <Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
    <MaxMessageSize>65000B</MaxMessageSize><FragmentSize>63000B</FragmentSize>
  </General>
  <Discovery>
    <ParticipantIndex>auto</ParticipantIndex>
    <MaxAutoParticipantIndex>{MOST_PARTICIPANTS}</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1" PruneDelay="inf"/></Peers>
    <SPDPInterval>1s</SPDPInterval>
  </Discovery>"""
LIMITS = f"""
  <Internal>
    <SocketReceiveBufferSize max="4MB"/>
    <MaxSampleSize>{MOST_SAMPLE_BYTES}B</MaxSampleSize>
    <Watermarks><WhcHigh>{WAITING_BYTES}B</WhcHigh></Watermarks>
  </Internal>
  <Tracing><Verbosity>severe</Verbosity><OutputFile>stderr</OutputFile></Tracing>"""

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

    def reader(self, topic: str, kind: str) -> "TopicReader":
        """Of a topic's messages of this type. Raises Ros2Error."""
        return TopicReader(self, topic, kind)

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
    def readers(self) -> int:
        """How many there are now."""
        return int(self._writer.get_publication_matched_status().current_count)

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


class TopicReader:
    """Of all writers of a topic: reliable, until there are only such as are not. It is given back when nobody
    holds it.

    lost: messages that DDS knows it has lost. One thread at a time.
    """

    def __init__(self, participant: Participant, topic: str, kind: str) -> None:
        self._participant, self._topic = participant, participant.topic(topic, kind)
        self._lost_before = 0
        self._begin(library("qos").Policy.Reliability.Reliable(max_blocking_time=0))

    def take(self, wait_s: float) -> list[bytes]:
        """What has come, oldest first; without anything, what comes first within this time."""
        if not self._waits.wait(round(1e9 * wait_s)):
            self._match()
            return []
        samples = self._reader.take(READER_MESSAGES)
        return [sample.cdr for sample in samples if isinstance(sample, self._topic.data_type)]

    @property
    def lost(self) -> int:
        return self._lost_before + int(self._reader.get_sample_lost_status().total_count)

    def _match(self) -> None:
        """A reliable reader gets nothing from writers that are not, and another gets all."""
        refused = self._reader.get_requested_incompatible_qos_status().total_count
        if refused and not self._reader.get_matched_publications():
            self._lost_before = self.lost
            self._begin(library("qos").Policy.Reliability.BestEffort)

    def _begin(self, reliability: Any) -> None:
        core, qos = library("core"), library("qos")
        policy = qos.Policy
        self._reader = library("sub").DataReader(
            self._participant.entity,
            self._topic,
            qos.Qos(reliability, policy.Durability.Volatile, policy.History.KeepLast(READER_MESSAGES)),
        )
        any_sample = core.SampleState.Any | core.ViewState.Any | core.InstanceState.Any
        self._waits = core.WaitSet(self._participant.entity)
        self._waits.attach(core.ReadCondition(self._reader, any_sample))
