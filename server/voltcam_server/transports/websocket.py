"""WebSocket: header and buffer in one binary message, each client behind a bounded queue of its own.

A client may ask for bundles: a message is then several of these, each after its length, u32 little-endian.
"""

import asyncio
import contextlib
import struct
import threading
from collections import deque
from typing import ClassVar

from starlette.websockets import WebSocket, WebSocketDisconnect

from voltcam_client.packet import TOPIC_EVENTS, pack_message

from ..messages import Message
from .transport import ClientStatus, Transport, TransportStatus

CLIENT_BYTES = 8 * 2**20
MOST_CLIENTS = 32  # of a camera: what waits for all of them is bounded, too
TRY_AGAIN_LATER = 1013  # WebSocket close code
LENGTH = struct.Struct("<I")


class _Client:
    """A queue between the transport's thread, which offers, and the event loop, which sends."""

    def __init__(self, address: str, topic: bytes, encoding: str, bundle_s: float) -> None:
        self.address, self.topic, self.encoding = address, topic, encoding
        self.bundle_s = bundle_s
        self.sent = self.dropped = 0
        self._queue: deque[bytes] = deque()
        self._bytes = 0
        self._lock = threading.Lock()
        self._loop = asyncio.get_running_loop()
        self._filled = asyncio.Event()

    def offer(self, data: bytes) -> None:
        """From any thread: queue a message; the oldest goes when the client is too far behind."""
        with self._lock:
            first = not self._queue
            self._queue.append(data)
            self._bytes += len(data)
            while self._bytes > CLIENT_BYTES and len(self._queue) > 1:
                self._bytes -= len(self._queue.popleft())
                self.dropped += 1
        if not first:
            return
        with contextlib.suppress(RuntimeError):  # the loop has been closed
            self._loop.call_soon_threadsafe(self._filled.set)

    async def take(self) -> tuple[bytes, int]:
        """What is to be sent next, and how many messages that is."""
        while True:
            with self._lock:
                if self._queue and not self.bundle_s:
                    data = self._queue.popleft()
                    self._bytes -= len(data)
                    return data, 1
                if not self._queue:
                    self._filled.clear()
            await self._filled.wait()
            if self.bundle_s:
                await asyncio.sleep(self.bundle_s)
                return self._bundle()

    def _bundle(self) -> tuple[bytes, int]:
        """All that waits, each message after its length."""
        with self._lock:
            waiting = list(self._queue)
            self._queue.clear()
            self._bytes = 0
            self._filled.clear()
        return b"".join(part for data in waiting for part in (LENGTH.pack(len(data)), data)), len(waiting)

    @property
    def status(self) -> ClientStatus:
        events = self.topic == TOPIC_EVENTS
        return ClientStatus(
            address=self.address,
            topic=self.topic.decode(),
            encoding=self.encoding if events else None,
            sent=self.sent,
            dropped=self.dropped,
        )


class WebSocketTransport(Transport):
    """Sends to the clients that `serve` accepts, on uvicorn's event loop."""

    name: ClassVar[str] = "websocket"

    def __init__(self, address: str) -> None:
        super().__init__()
        self.address = address
        self._clients: list[_Client] = []  # replaced, never changed: the thread iterates over it
        self._sent = self._lost = 0  # by the outbox, and clients that have left

    @property
    def _has_audience(self) -> bool:
        return bool(self._clients)

    async def serve(self, websocket: WebSocket, topic: bytes, encoding: str, bundle_ms: float = 0) -> None:
        """Accept a client and send it all messages of a topic until it leaves.

        bundle_ms: wait so long, and send what has come as one: for clients to which a message is dear.
        """
        await websocket.accept()
        if len(self._clients) >= MOST_CLIENTS:
            await websocket.close(
                TRY_AGAIN_LATER, f"{MOST_CLIENTS} clients are here already: end one of them"
            )
            return
        peer = websocket.client
        client = _Client(f"{peer.host}:{peer.port}" if peer else "", topic, encoding, bundle_ms / 1000)
        self._clients = [*self._clients, client]
        sending = asyncio.create_task(self._send_to(client, websocket))
        try:
            while (await websocket.receive())["type"] != "websocket.disconnect":
                pass  # nothing that a client says matters here
        finally:
            sending.cancel()
            with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
                await sending
            self._clients = [other for other in self._clients if other is not client]
            if topic == TOPIC_EVENTS:
                self._sent += client.sent
                self._lost += client.dropped

    async def _send_to(self, client: _Client, websocket: WebSocket) -> None:
        while True:
            data, count = await client.take()
            await websocket.send_bytes(data)
            client.sent += count

    @property
    def status(self) -> TransportStatus:
        clients = [client.status for client in self._clients]
        watching = [client for client in clients if client.topic == TOPIC_EVENTS.decode()]
        return TransportStatus(
            address=self.address,
            packets_sent=self._sent + sum(client.sent for client in watching),
            packets_dropped=self._lost + sum(client.dropped for client in watching),
            clients=clients,
        )

    def _send(self, message: Message) -> None:
        packed: dict[str, bytes] = {}
        for client in self._clients:
            if client.topic == message.topic:
                if client.encoding not in packed:
                    header, buffer = message.parts(client.encoding)
                    packed[client.encoding] = pack_message(header, buffer)
                client.offer(packed[client.encoding])

    def _dropped(self, message: Message) -> None:
        self._lost += message.topic == TOPIC_EVENTS

    def _close(self) -> None:
        """The clients are the web server's to close."""
