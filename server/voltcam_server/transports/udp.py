"""UDP: events as datagrams to one address, in AEStream's or in faery's form. Nobody says whether they arrive.

spif: AEStream's words, x and y without a time (aestream, src/output/dvs_to_udp.cpp; SpiNNaker's spif).
t32_x16_y15_on1: faery's records, with the low 32 bits of the time (faery, udp_encoder.py).
"""

import logging
import socket
from collections.abc import Callable, Iterator
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_client.packet import TOPIC_EVENTS, Packet

from ..messages import Message
from ..problems import UsageError
from .transport import Transport, TransportStatus

OPTION = "--udp"
DATAGRAM_EVENTS = 128  # AEStream's receiver has no room for more
TIME_BITS = 32
SPIF_NO_TIME = 1 << 31
RECORD = np.dtype([("t", "<u4"), ("x", "<u2"), ("y_on", "<u2")])
NO_TIMES = "%s: this form has no times: a receiver has those of arrival only"
WRAPPED = (
    "%s: the events' clock has passed a multiple of 2^32 us, and the times that are sent begin anew at 0"
)


def _spif(events: NDArray[np.void]) -> bytes:
    """Words: bit 31 set for no time, x in bits 16 to 30, ON in bit 15, y in bits 0 to 14."""
    words = np.empty(events.size, "<u4")
    words[:] = SPIF_NO_TIME | events["x"].astype(np.uint32) << 16 | _on(events) << 15 | events["y"]
    return words.tobytes()


def _t32_x16_y15_on1(events: NDArray[np.void]) -> bytes:
    """Records: u32 time, u16 x, u16 with y above ON, which is bit 0."""
    records = np.empty(events.size, RECORD)
    records["t"] = (events["t"] & (2**TIME_BITS - 1)).astype("<u4")
    records["x"] = events["x"]
    records["y_on"] = (events["y"].astype("<u4") << 1 | _on(events)).astype("<u2")
    return records.tobytes()


def _on(events: NDArray[np.void]) -> NDArray[np.uint32]:
    return (events["p"] > 0).astype(np.uint32)


class _Form(NamedTuple):
    """width, height: the largest camera, pixels. encode: events of a datagram to its bytes."""

    width: int
    height: int
    has_times: bool
    encode: Callable[[NDArray[np.void]], bytes]


FORMS = {
    "spif": _Form(2**15, 2**15, False, _spif),
    "t32_x16_y15_on1": _Form(2**16, 2**15, True, _t32_x16_y15_on1),
}


class UdpTransport(Transport):
    """Sends to FORM://HOST:PORT. Raises UsageError for an unknown host, and a camera too large for the form.

    A packet counts as dropped where the network takes only a part of its datagrams.
    """

    name: ClassVar[str] = "udp"

    def __init__(self, url: str, width: int, height: int) -> None:
        super().__init__()
        name, _, address = url.partition("://")
        self._form = FORMS[name]
        if width > self._form.width or height > self._form.height:
            most = f"{self._form.width} x {self._form.height}"
            raise UsageError(
                f"{OPTION} {name} holds {most} pixels, not {width} x {height}: give {OPTION} off"
            )
        self._url = url
        self._sent = self._lost = 0
        self._wraps = 0
        self._socket, self._to = _socket_to(address)
        if not self._form.has_times:
            logging.getLogger(__name__).warning(NO_TIMES, url)

    @property
    def status(self) -> TransportStatus:
        return TransportStatus(address=self._url, packets_sent=self._sent, packets_dropped=self._lost)

    def _send(self, message: Message) -> None:
        if message.topic != TOPIC_EVENTS or message.content.events.size == 0:
            return
        try:
            for datagram in self._datagrams(message.content):
                self._socket.sendto(datagram, self._to)
            self._sent += 1
        except OSError:  # its queue is full, or there is no way to the host
            self._lost += 1

    def _datagrams(self, packet: Packet) -> Iterator[memoryview]:
        """None of them goes over a wrap of its times: faery looks for one between datagrams only."""
        wraps = packet.events["t"] >> TIME_BITS if self._form.has_times else np.zeros(packet.events.size)
        for run in np.split(packet.events, np.flatnonzero(np.diff(wraps)) + 1):
            self._tell_of_wrap(int(run["t"][0]) >> TIME_BITS)
            data = memoryview(self._form.encode(run))  # at once: twice as fast as each by itself
            most_bytes = DATAGRAM_EVENTS * (len(data) // run.size)
            for first in range(0, len(data), most_bytes):
                yield data[first : first + most_bytes]

    def _tell_of_wrap(self, wraps: int) -> None:
        if self._form.has_times and wraps != self._wraps:
            self._wraps = wraps
            logging.getLogger(__name__).warning(WRAPPED, self._url)

    def _dropped(self, message: Message) -> None:
        self._lost += message.topic == TOPIC_EVENTS

    def _close(self) -> None:
        self._socket.close()


def _socket_to(address: str) -> tuple[socket.socket, tuple[object, ...]]:
    """A socket that does not wait, and where it sends to. Raises UsageError."""
    host, _, port = address.rpartition(":")
    try:
        family, kind, proto, _, to = socket.getaddrinfo(host.strip("[]"), int(port), type=socket.SOCK_DGRAM)[
            0
        ]
        sender = socket.socket(family, kind, proto)
    except OSError as error:
        raise UsageError(f"{address}: {error.strerror}: give {OPTION} FORM://HOST:PORT") from None
    sender.setblocking(False)
    return sender, to
