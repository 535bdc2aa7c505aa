"""UDP: events in datagrams to one address, in a form that others read. Nobody says whether they arrive."""

import socket
from typing import ClassVar

from voltcam_client.datagrams import MOST_SIDE, DatagramForm, datagrams
from voltcam_client.packet import TOPIC_EVENTS

from ..log import log
from ..messages import Message
from ..problems import UsageError
from .transport import Transport, TransportStatus

NOT_CARRIED = {
    "t32_x16_y15_on1": "times modulo 2^32 us (71.6 minutes), and no frames",
    "spif": "no times of events, and no frames",
}


class UdpTransport(Transport):
    """Sends to HOST:PORT. Raises UsageError for an address that is none, and a sensor that no form holds."""

    name: ClassVar[str] = "udp"

    def __init__(self, address: str, form: DatagramForm, width: int, height: int) -> None:
        super().__init__()
        if max(width, height) > MOST_SIDE:
            raise UsageError(f"--udp holds {MOST_SIDE} pixels a side, not {width} x {height}")
        host, _, port = address.rpartition(":")
        if not 1 <= int(port) <= 65535:  # getaddrinfo would take it modulo 65536
            raise UsageError(f"--udp {address}: ports go from 1 to 65535: give HOST:PORT")
        try:
            family, *_, to = socket.getaddrinfo(host.strip("[]"), int(port), type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise UsageError(f"--udp {address}: {error.strerror}: give HOST:PORT") from None
        self._to, self._address, self._form = to, address, form
        self._sent = self._lost = 0
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        log.info("udp %s: %s carries %s", address, form, NOT_CARRIED[form])

    @property
    def status(self) -> TransportStatus:
        return TransportStatus(
            address=f"udp://{self._address}", packets_sent=self._sent, packets_dropped=self._lost
        )

    def _send(self, message: Message) -> None:
        if message.topic != TOPIC_EVENTS:
            return
        try:
            for datagram in datagrams(message.content.events, self._form):
                self._socket.sendto(datagram, self._to)
            self._sent += 1
        except OSError:  # what waits to leave this machine is full, or there is no way to the host
            self._lost += 1

    def _dropped(self, message: Message) -> None:
        self._lost += message.topic == TOPIC_EVENTS

    def _close(self) -> None:
        self._socket.close()
