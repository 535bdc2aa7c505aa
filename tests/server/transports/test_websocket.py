"""WebSocket: messages to many clients, and what a slow one costs."""

import contextlib
import threading
import time
from collections.abc import Iterator
from functools import partial

import numpy as np
import pytest
from fastapi import FastAPI, WebSocket
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from voltcam_client.packet import (
    EVENT,
    TOPIC_EVENTS,
    TOPIC_FRAMES,
    FrameMessage,
    Packet,
    decode_frame,
    decode_message,
    unpack_message,
)
from voltcam_server.messages import Message, events_message, frame_message
from voltcam_server.transports import WebSocketTransport
from voltcam_server.transports.transport import OUTBOX_BYTES
from voltcam_server.transports.websocket import MOST_CLIENTS

from ..rig import PATIENCE_S, until, web_server


def packet(seq: int) -> Packet:
    events = np.array([(5, 1, 2, True), (9, 3, 4, False)], EVENT)
    return Packet(events=events, width=128, height=128, seq=seq, time_base_ns=0, stamp_ns=1)


class Running:
    def __init__(self, transport: WebSocketTransport, address: str) -> None:
        self.transport, self.address = transport, address

    @contextlib.contextmanager
    def client(self, path: str, max_queue: int = 16) -> Iterator[ClientConnection]:
        count = len(self.transport.status.clients)
        with connect(f"ws://{self.address}{path}", max_size=None, max_queue=max_queue) as client:
            until(lambda: len(self.transport.status.clients) > count, "the client is taken in")
            yield client


@pytest.fixture
def running() -> Iterator[Running]:
    transport = WebSocketTransport("here")
    app = FastAPI()

    @app.websocket("/events")
    async def events(websocket: WebSocket, encoding: str = "libcaer", bundle_ms: float = 0) -> None:
        await transport.serve(websocket, TOPIC_EVENTS, encoding, bundle_ms)

    @app.websocket("/frames")
    async def frames(websocket: WebSocket) -> None:
        await transport.serve(websocket, TOPIC_FRAMES, "")

    transport.start()
    with web_server(app) as address:
        yield Running(transport, address)
    transport.stop()


def receive(client: ClientConnection) -> bytes:
    message = client.recv(timeout=PATIENCE_S)
    assert isinstance(message, bytes)
    return message


def test_every_client_gets_its_topic_in_its_encoding_and_none_is_encoded_twice(running: Running) -> None:
    encoded: list[str] = []
    original = events_message(packet(7))

    def encode(encoding: str) -> tuple[bytes, ...]:
        encoded.append(encoding)
        return original.parts(encoding)

    with (
        running.client("/events") as plain,
        running.client("/events?encoding=evt3") as evt3,
        running.client("/events?encoding=evt3") as again,
        running.client("/frames") as frames,
    ):
        assert plain.response is not None
        assert "permessage-deflate" not in plain.response.headers.get("Sec-WebSocket-Extensions", "")
        running.transport.publish(Message(TOPIC_EVENTS, 100, encode))
        image = np.arange(6, dtype=np.uint8).reshape(2, 3)
        running.transport.publish(frame_message(FrameMessage(image=image, seq=3, t_us=5, stamp_ns=1)))
        for client, encoding in ((plain, "libcaer"), (evt3, "evt3"), (again, "evt3")):
            received = decode_message(receive(client))
            assert (received.seq, received.encoding) == (7, encoding)
            np.testing.assert_array_equal(received.events, packet(7).events)
        np.testing.assert_array_equal(decode_frame(*unpack_message(receive(frames))).image, image)
    assert sorted(encoded) == ["evt3", "libcaer"]


def test_a_client_that_never_reads_costs_only_itself(running: Running) -> None:
    """1000 messages of 64 KB: the reader gets all, the other loses the oldest of what waits for it."""
    total, window = 1000, 50
    with running.client("/events", max_queue=1) as dead, running.client("/events") as reader:
        room = threading.Semaphore(window)
        buffer = bytes(65536)

        def publish() -> None:
            for seq in range(total):
                assert room.acquire(timeout=PATIENCE_S)
                parts = (seq.to_bytes(4, "little"), buffer)
                running.transport.publish(Message(b"events", 65536, partial(lambda parts, _: parts, parts)))

        publisher = threading.Thread(target=publish)
        publisher.start()
        for seq in range(total):
            assert int.from_bytes(receive(reader)[:4], "little") == seq
            room.release()
        publisher.join()
        status = running.transport.status
        slow = [client for client in status.clients if client.dropped]
        assert len(slow) == 1
        assert slow[0].dropped == status.packets_dropped > 500
        got = [int.from_bytes(receive(dead)[:4], "little")]
        while got[-1] != total - 1:  # the newest is never dropped
            got.append(int.from_bytes(receive(dead)[:4], "little"))
        assert got == sorted(got)
        assert len(got) == total - slow[0].dropped
    until(lambda: not running.transport.status.clients, "both have left")
    assert running.transport.status.packets_sent == 2 * total - slow[0].dropped


def test_clients_come_and_go_and_may_say_what_they_want(running: Running) -> None:
    with running.client("/frames") as frames:
        with running.client("/events") as client:
            client.send("text")
            client.send(b"bytes")
            running.transport.publish(events_message(packet(1)))
            assert decode_message(receive(client)).seq == 1
        until(lambda: len(running.transport.status.clients) == 1, "the client has left")
        running.transport.publish(events_message(packet(2)))
        image = np.zeros((2, 3), dtype=np.uint8)
        running.transport.publish(frame_message(FrameMessage(image=image, seq=0, t_us=5, stamp_ns=1)))
        receive(frames)  # the frame comes after packet 2, which no one was there for
        with running.client("/events") as client:
            running.transport.publish(events_message(packet(3)))
            assert decode_message(receive(client)).seq == 3


def test_who_asks_for_bundles_gets_few_messages_and_all_packets(running: Running) -> None:
    with running.client("/events?bundle_ms=50") as client:
        for seq in range(300):
            running.transport.publish(events_message(packet(seq)))
            time.sleep(0.001)
        seqs: list[int] = []
        messages = 0
        while len(seqs) < 300:
            data = client.recv(timeout=PATIENCE_S)
            assert isinstance(data, bytes)
            messages += 1
            while data:
                length = int.from_bytes(data[:4], "little")
                seqs.append(decode_message(data[4 : 4 + length]).seq)
                data = data[4 + length :]
        assert seqs == list(range(300))
        assert messages < 30
        until(lambda: running.transport.status.packets_sent == 300, "each is counted")


def test_so_many_clients_and_no_more(running: Running) -> None:
    with contextlib.ExitStack() as stack:
        for _ in range(MOST_CLIENTS):
            stack.enter_context(running.client("/events"))
        with (
            connect(f"ws://{running.address}/events") as late,
            pytest.raises(ConnectionClosed, match="32 clients are here already"),
        ):
            late.recv(timeout=PATIENCE_S)
        assert len(running.transport.status.clients) == MOST_CLIENTS
    until(lambda: not running.transport.status.clients, "they have gone")
    with running.client("/events"):
        pass


def test_without_clients_nothing_waits_and_nothing_is_dropped() -> None:
    transport = WebSocketTransport("here")  # its thread is not started
    for _ in range(3):
        transport.publish(Message(TOPIC_EVENTS, OUTBOX_BYTES, lambda _: (b"",)))
    assert transport.status.packets_dropped == 0
