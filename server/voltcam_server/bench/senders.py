"""What `voltcam bench transports` sends with: each transport as the daemon has it.

Another transport is a function here, a line in SENDERS, and a receiver of that name in `receivers`.
"""

import contextlib
import importlib.util
import os
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import NamedTuple

import numpy as np
import uvicorn
from fastapi import FastAPI, WebSocket

from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import events_packet
from voltcam_client.encodings import Events
from voltcam_client.errors import VoltcamError
from voltcam_client.packet import TOPIC_EVENTS, FrameMessage, Packet, encode_packet, pack_message

from ..messages import events_message, frame_message
from ..transports import (
    DvTransport,
    FoxgloveTransport,
    Ros2Transport,
    Transport,
    UdpTransport,
    WebSocketTransport,
    ZeroMQTransport,
)
from .plain import Sender, free_udp_port, plain_tcp, plain_udp
from .receivers import IO_S, SPIF_TIME_BITS
from .ros1 import bridge

WIDTH, HEIGHT = 346, 260
ENCODING = "libcaer"
POLL_S = 0.01
AHEAD = 40  # packets under way: 5 MB of DV, less than what makes a transport drop


class Kind(NamedTuple):
    """open: a sender for as long as it is needed. wire_bytes: of a packet.

    plain: the socket beside it, None for none; plain_receiver: that of it. needs: a library's module, and the
    extra that brings it. ahead: packets under way at most. period_s: from one packet to the next, where
    latency is measured. pictures: it is they that arrive, not events.
    """

    open: Callable[[], AbstractContextManager[Sender]]
    wire_bytes: Callable[[Events], int]
    plain: Callable[[int], AbstractContextManager[Sender]] | None = plain_tcp
    plain_receiver: str = "tcp"
    needs: tuple[str, str] | None = None
    ahead: int = AHEAD
    period_s: float = 0.001
    pictures: bool = False

    @property
    def there(self) -> bool:
        return self.needs is None or importlib.util.find_spec(self.needs[0]) is not None


@contextlib.contextmanager
def zeromq() -> Iterator[Sender]:
    transport = ZeroMQTransport("tcp://127.0.0.1:0", ENCODING)
    with _running(transport):
        yield Sender(transport.endpoint, _publish(transport))


@contextlib.contextmanager
def ros1() -> Iterator[Sender]:
    """All the way: ZeroMQ to `voltcam ros1`, and from there."""
    with zeromq() as sender, bridge(sender.address, IO_S) as uri:
        yield sender._replace(address=uri)


@contextlib.contextmanager
def ros2() -> Iterator[Sender]:
    namespace = f"bench_{os.getpid()}_{time.time_ns()}"
    transport = Ros2Transport(namespace, ENCODING, {TOPIC_EVENTS: 1 << 16})
    with _running(transport):
        yield Sender(f"{namespace}/events", _publish(transport))


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
def udp_spif() -> Iterator[Sender]:
    """The form has no times: they are in x and y, which the receiver knows."""
    with _udp("spif") as sender:

        def send(events: Events) -> None:
            bits = 2**SPIF_TIME_BITS - 1
            events["x"], events["y"] = events["t"] >> SPIF_TIME_BITS & bits, events["t"] & bits
            sender.send(events)

        yield sender._replace(send=send)


@contextlib.contextmanager
def udp_t32() -> Iterator[Sender]:
    with _udp("t32_x16_y15_on1") as sender:
        yield sender


@contextlib.contextmanager
def _udp(form: str) -> Iterator[Sender]:
    host, port = free_udp_port()
    transport = UdpTransport(f"{form}://{host}:{port}", WIDTH, HEIGHT)
    with _running(transport):
        yield Sender(f"{host}:{port}", _publish(transport), _taken(transport))


@contextlib.contextmanager
def foxglove_frames() -> Iterator[Sender]:
    """A frame for each packet of events, of the same time."""
    transport = FoxgloveTransport("127.0.0.1:0", "bench", WIDTH, HEIGHT)
    image = np.zeros((HEIGHT, WIDTH), np.uint8)

    def send(events: Events) -> None:
        transport.publish(
            frame_message(FrameMessage(image=image, seq=0, t_us=int(events["t"][-1]), stamp_ns=0))
        )

    with _running(transport):
        yield Sender(transport.status.address, send)


@contextlib.contextmanager
def foxglove_preview() -> Iterator[Sender]:
    """Events of now: pictures come as the events' clock goes on."""
    transport = FoxgloveTransport("127.0.0.1:0", "bench", WIDTH, HEIGHT)
    publish = _publish(transport)

    def send(events: Events) -> None:
        events = events.copy()
        events["t"] = time.time_ns() // 1000
        publish(events)

    with _running(transport):
        yield Sender(transport.status.address, send, _taken(transport))


@contextlib.contextmanager
def _running(transport: Transport) -> Iterator[None]:
    transport.start()
    try:
        yield
    finally:
        transport.stop()


def _publish(transport: Transport) -> Callable[[Events], None]:
    return lambda events: transport.publish(events_message(_packet(events)))


def _taken(transport: Transport) -> Callable[[], int]:
    def taken() -> int:
        status = transport.status
        return status.packets_sent + status.packets_dropped

    return taken


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


def _picture_bytes(_: Events) -> int:
    return WIDTH * HEIGHT


FOXGLOVE, CYCLONE, DV = ("foxglove", "foxglove"), ("cyclonedds", "ros2"), ("dv_processing", "dv")
SENDERS: dict[str, Kind] = {
    "zeromq": Kind(zeromq, _message_bytes),
    "websocket": Kind(websocket, _message_bytes),
    "dv": Kind(dv, _dv_bytes, needs=DV),
    "ros1": Kind(ros1, _message_bytes),
    "ros2": Kind(ros2, _message_bytes, needs=CYCLONE, ahead=10),  # 16 wait for a reader of DDS
    "udp spif": Kind(udp_spif, lambda events: 4 * events.size, plain_udp, "udp, 4 bytes an event"),
    "udp t32_x16_y15_on1": Kind(udp_t32, lambda events: 8 * events.size, plain_udp, "udp, 8 bytes an event"),
    "foxglove frames": Kind(
        foxglove_frames, _picture_bytes, needs=FOXGLOVE, ahead=8, period_s=0.01, pictures=True
    ),
    "foxglove preview": Kind(foxglove_preview, _picture_bytes, None, needs=FOXGLOVE, pictures=True),
}


def left_out() -> list[str]:
    """A line for each transport whose library is missing."""
    return [
        f"{name} is left out: pip install 'voltcam[{kind.needs[1]}]'"
        for name, kind in SENDERS.items()
        if kind.needs and not kind.there
    ]
