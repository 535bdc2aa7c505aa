"""What `voltcam bench transports` sends with: each transport as the daemon has it, and a plain TCP socket.

Another transport is a function here, a line in SENDERS, and a receiver of that name in `bench_receivers`.
"""

import contextlib
import importlib.util
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import NamedTuple

import uvicorn
from fastapi import FastAPI, WebSocket

from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import events_packet
from voltcam_client.encodings import Events
from voltcam_client.errors import VoltcamError
from voltcam_client.packet import TOPIC_EVENTS, Packet, encode_packet, pack_message

from .bench_receivers import HEAD, IO_S
from .messages import events_message
from .transports import DvTransport, Transport, WebSocketTransport, ZeroMQTransport

WIDTH, HEIGHT = 346, 260
ENCODING = "libcaer"
POLL_S = 0.01


class Sender(NamedTuple):
    """address: for the receiver. send: some events, without waiting for anyone."""

    address: str
    send: Callable[[Events], None]


class Kind(NamedTuple):
    """open: a sender for as long as it is needed. wire_bytes: of a packet. there: whether its receiver is."""

    open: Callable[[], AbstractContextManager[Sender]]
    wire_bytes: Callable[[Events], int]
    there: bool = True


@contextlib.contextmanager
def zeromq() -> Iterator[Sender]:
    transport = ZeroMQTransport("tcp://127.0.0.1:0", ENCODING)
    with _running(transport):
        yield Sender(transport.endpoint, _publish(transport))


@contextlib.contextmanager
def websocket() -> Iterator[Sender]:
    """Behind uvicorn, as in a daemon."""
    transport, app = WebSocketTransport(""), FastAPI()

    @app.websocket("/events")
    async def events(websocket: WebSocket) -> None:
        await transport.serve(websocket, TOPIC_EVENTS, ENCODING)

    server = uvicorn.Server(
        uvicorn.Config(app, log_level="error", lifespan="off", ws_per_message_deflate=False)
    )
    with socket.create_server(("127.0.0.1", 0)) as listener, _running(transport):
        thread = threading.Thread(target=server.run, args=([listener],), daemon=True)
        thread.start()
        until_s = time.monotonic() + IO_S
        while not server.started:
            if time.monotonic() > until_s:
                raise VoltcamError(f"the web server does not run within {IO_S:g} s")
            time.sleep(POLL_S)
        yield Sender(f"ws://127.0.0.1:{listener.getsockname()[1]}/events", _publish(transport))
        server.should_exit = server.force_exit = True
        thread.join(IO_S)


@contextlib.contextmanager
def dv() -> Iterator[Sender]:
    transport = DvTransport("127.0.0.1:0", WIDTH, HEIGHT, "EMU00001")
    with _running(transport):
        yield Sender(transport.address, _publish(transport))


@contextlib.contextmanager
def tcp(packet_bytes: int) -> Iterator[Sender]:
    """Ready-made bytes to one receiver; only the time in front changes."""
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
def _running(transport: Transport) -> Iterator[None]:
    transport.start()
    try:
        yield
    finally:
        transport.stop()


def _publish(transport: Transport) -> Callable[[Events], None]:
    return lambda events: transport.publish(events_message(_packet(events)))


def _packet(events: Events) -> Packet:
    base_us = int(events["t"][0])
    return Packet(
        events=events, width=WIDTH, height=HEIGHT, seq=0, time_base_ns=1000 * base_us, stamp_ns=0,
        encoding=ENCODING,
    )  # fmt: skip


def _message_bytes(events: Events) -> int:
    return len(pack_message(*encode_packet(_packet(events))))


def _dv_bytes(events: Events) -> int:
    return len(events_packet(events, PACKET.size))


SENDERS: dict[str, Kind] = {
    "zeromq": Kind(zeromq, _message_bytes),
    "websocket": Kind(websocket, _message_bytes),
    "dv": Kind(dv, _dv_bytes, importlib.util.find_spec("dv_processing") is not None),
}
