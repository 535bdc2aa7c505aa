"""iniVation's DV network protocol: a TCP server for each stream, as dv-processing's NetworkReader reads it.

The ports follow each other: events, frames, triggers, IMU. A reader gets the stream's header when it
connects, then packets, each after i32 stream (0) and i32 bytes. It says nothing; who speaks is no reader, and
is let go. A reader that is too slow loses the oldest packets that wait for it, whole ones.
"""

import contextlib
import logging
import selectors
import socket
import time
from collections.abc import Callable
from functools import partial
from itertools import islice
from typing import Any, ClassVar, NamedTuple

from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import (
    LARGEST_COORDINATE,
    events_packet,
    frame_packet,
    imu_packet,
    triggers_packet,
)
from voltcam_client.dv.streams import DvStream, camera_name, header_bytes
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES, FrameMessage, Packet
from voltcam_client.samples import TOPIC_IMU, TOPIC_TRIGGERS, SamplesMessage

from ..listening import address_of, listen
from ..messages import Message
from ..problems import UsageError
from .dv_reader import DvReader
from .transport import Transport, TransportStatus

MOST_READERS = 32  # of a camera: what waits for all of them is bounded
AT_ONCE = 64  # messages that are sent between two looks at the connections
FREE_PORTS_TRIES = 50
OPTION = "--dv"
WAKE_BYTES = 4096
NO_DESCRIPTORS_S = 0.05
TOLD_S = 10.0


def _events(packet: Packet) -> bytearray:
    return events_packet(packet.events, PACKET.size)


def _frame(frame: FrameMessage) -> bytearray:
    exposure_us = frame.exposure_us or (frame.t_us, frame.t_us)
    return bytearray(PACKET.size) + frame_packet(frame.image, exposure_us, frame.frame_us)


def _imu(message: SamplesMessage) -> bytearray:
    return bytearray(PACKET.size) + imu_packet(message.samples)


def _triggers(message: SamplesMessage) -> bytearray:
    return bytearray(PACKET.size) + triggers_packet(message.samples)


class _Kind(NamedTuple):
    """Of a stream: where it is after the first port, its name in DV, and how its packets are made."""

    port: int
    name: str
    encode: Callable[[Any], bytearray]


KINDS: dict[bytes, _Kind] = {
    TOPIC_EVENTS: _Kind(0, "EVTS", _events),
    TOPIC_FRAMES: _Kind(1, "FRME", _frame),
    TOPIC_TRIGGERS: _Kind(2, "TRIG", _triggers),
    TOPIC_IMU: _Kind(3, "IMUS", _imu),
}


class DvTransport(Transport):
    """Listens at HOST:PORT and the ports after it, at once. Raises UsageError when that is not possible.

    Port 0 takes free ones. serial: of the camera, whose model its size says.
    """

    name: ClassVar[str] = "dv"

    def __init__(
        self, address: str, width: int, height: int, serial: str, topics: tuple[bytes, ...] = tuple(KINDS)
    ) -> None:
        super().__init__()
        if max(width, height) > LARGEST_COORDINATE + 1:
            most = LARGEST_COORDINATE + 1
            raise UsageError(f"DV holds {most} pixels a side, not {width} x {height}: give {OPTION} off")
        source = camera_name(width, height, serial)
        self._headers = {
            topic: header_bytes([DvStream(0, KINDS[topic].name, source, _size(topic, width, height))])
            for topic in topics
        }
        self._sent = self._lost = 0  # by the outbox, and readers that have left
        self._told_s = -TOLD_S
        self._readers: tuple[DvReader, ...] = ()  # replaced, never changed: any thread may go through it
        self._listeners = _listeners(address, topics)
        self.address = address_of(self._listeners[topics[0]])
        self._selector = selectors.DefaultSelector()
        self._wake, self._woken = socket.socketpair()
        for end in (self._wake, self._woken):
            end.setblocking(False)
        self._selector.register(self._woken, selectors.EVENT_READ, self._awake)
        for topic, listener in self._listeners.items():
            listener.setblocking(False)
            self._selector.register(listener, selectors.EVENT_READ, partial(self._accept, topic))

    @property
    def status(self) -> TransportStatus:
        clients = [reader.status for reader in self._readers]
        watching = [client for client in clients if client.topic == TOPIC_EVENTS.decode()]
        return TransportStatus(
            address=f"tcp://{self.address}",
            packets_sent=self._sent + sum(client.sent for client in watching),
            packets_dropped=self._lost + sum(client.dropped for client in watching),
            clients=clients,
        )

    def _tell(self) -> None:
        super()._tell()
        with contextlib.suppress(OSError):  # full: it is awake already; closed: it has ended
            self._wake.send(b"\0")

    def _run(self) -> None:
        try:
            while not self._stopping:
                for key, _ in self._selector.select(0 if self._outbox else None):
                    key.data()
                for message in islice(iter(self._take, None), AT_ONCE):
                    self._send(message)
        except Exception as error:
            self.failure = error

    def _awake(self) -> None:
        self._woken.recv(WAKE_BYTES)

    def _accept(self, topic: bytes) -> None:
        try:
            connection, _ = self._listeners[topic].accept()
        except OSError:  # it has left already, or there are no descriptors, of which others have to give back
            time.sleep(NO_DESCRIPTORS_S)
            return
        if len(self._readers) >= MOST_READERS:
            connection.close()
            self._tell_of_too_many()
            return
        try:
            reader = DvReader(connection, topic, self._headers[topic])
        except OSError:
            connection.close()
            return
        self._selector.register(connection, selectors.EVENT_READ, partial(self._attend, reader))
        self._readers = (*self._readers, reader)
        self._flush(reader)

    def _attend(self, reader: DvReader) -> None:
        """Its connection takes more, or there is something to hear."""
        if reader.has_left():
            self._let_go(reader)
        else:
            self._flush(reader)

    def _flush(self, reader: DvReader) -> None:
        try:
            all_left = reader.flush()
        except OSError:
            self._let_go(reader)
            return
        waits = selectors.EVENT_READ if all_left else selectors.EVENT_READ | selectors.EVENT_WRITE
        if waits != self._selector.get_key(reader.socket).events:
            self._selector.modify(reader.socket, waits, partial(self._attend, reader))

    def _let_go(self, reader: DvReader) -> None:
        self._selector.unregister(reader.socket)
        reader.socket.close()
        self._readers = tuple(other for other in self._readers if other is not reader)
        if reader.topic == TOPIC_EVENTS:
            self._sent += reader.sent
            self._lost += reader.dropped

    def _send(self, message: Message) -> None:
        readers = [reader for reader in self._readers if reader.topic == message.topic]
        if not readers or _is_empty(message):
            return
        packet = KINDS[message.topic].encode(message.content)
        PACKET.pack_into(packet, 0, 0, len(packet) - PACKET.size)
        for reader in readers:
            reader.offer(packet)
            self._flush(reader)

    def _dropped(self, message: Message) -> None:
        self._lost += message.topic == TOPIC_EVENTS

    def _tell_of_too_many(self) -> None:
        if time.monotonic() - self._told_s > TOLD_S:
            self._told_s = time.monotonic()
            words = "%d readers are here already: another is not let in"
            logging.getLogger(__name__).warning("%s: " + words, self.address, MOST_READERS)

    def _close(self) -> None:
        for reader in self._readers:
            reader.socket.close()
        for listener in self._listeners.values():
            listener.close()
        self._selector.close()
        self._wake.close()
        self._woken.close()


def _is_empty(message: Message) -> bool:
    """A packet without events says how time goes on. A camera of DV has none, and programs fail at one."""
    return message.topic == TOPIC_EVENTS and message.content.events.size == 0


def _size(topic: bytes, width: int, height: int) -> tuple[int, int] | None:
    return (width, height) if topic in (TOPIC_EVENTS, TOPIC_FRAMES) else None


def _listeners(address: str, topics: tuple[bytes, ...]) -> dict[bytes, socket.socket]:
    """One for each stream. Raises UsageError."""
    host, _, port = address.rpartition(":")
    if int(port):
        return _at(host, int(port), topics)
    for _ in range(FREE_PORTS_TRIES):
        with listen(address, OPTION) as free:
            first = int(address_of(free).rpartition(":")[2])
        with contextlib.suppress(UsageError):  # one of the next is not free
            return _at(host, first, topics)
    raise UsageError(f"{address}: no {len(topics)} ports in a row are free: choose them with {OPTION}")


def _at(host: str, first: int, topics: tuple[bytes, ...]) -> dict[bytes, socket.socket]:
    with contextlib.ExitStack() as stack:
        listeners = {
            topic: stack.enter_context(listen(f"{host}:{first + KINDS[topic].port}", OPTION))
            for topic in topics
        }
        stack.pop_all()  # they stay open
        return listeners
