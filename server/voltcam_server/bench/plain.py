"""The plain sockets that `voltcam bench transports` holds each transport against: ready-made bytes."""

import contextlib
import socket
from collections.abc import Callable, Iterator
from typing import NamedTuple

from voltcam_client.encodings import Events

from ..transports.udp import DATAGRAM_EVENTS
from .receivers import HEAD, IO_S


class Sender(NamedTuple):
    """address: for the receiver. send: some events, without waiting for anyone.

    taken: packets that have left, where the receiver may not get all of them.
    """

    address: str
    send: Callable[[Events], None]
    taken: Callable[[], int] | None = None


@contextlib.contextmanager
def plain_tcp(packet_bytes: int) -> Iterator[Sender]:
    """To one receiver; only the time in front changes."""
    packet, connections = bytearray(packet_bytes), list[socket.socket]()
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.setblocking(False)

        def send(events: Events) -> None:
            if not connections:
                try:
                    connections.append(listener.accept()[0])
                except BlockingIOError:  # nobody is here yet
                    return
                connections[0].setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                connections[0].settimeout(IO_S)
            HEAD.pack_into(packet, 0, events.size, int(events["t"][-1]))
            connections[0].sendall(packet)

        yield Sender(f"127.0.0.1:{listener.getsockname()[1]}", send)
        for connection in connections:
            connection.close()


@contextlib.contextmanager
def plain_udp(packet_bytes: int) -> Iterator[Sender]:
    """In datagrams of as many events as the transport's; the number and time in front of each change."""
    buffer, sent = bytearray(packet_bytes), [0]
    to = free_udp_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:

        def send(events: Events) -> None:
            t_us, event_bytes = int(events["t"][-1]), packet_bytes // events.size
            for first in range(0, events.size, DATAGRAM_EVENTS):
                count = min(DATAGRAM_EVENTS, events.size - first)
                HEAD.pack_into(buffer, 0, count, t_us)
                sender.sendto(memoryview(buffer)[: count * event_bytes], to)
            sent[0] += 1

        yield Sender(f"{to[0]}:{to[1]}", send, lambda: sent[0])


def free_udp_port() -> tuple[str, int]:
    """HOST, PORT that a receiver can have."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        host, port = probe.getsockname()
        return host, port
