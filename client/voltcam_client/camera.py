"""A running camera as an iterable of packets: `for packet in EventCamera("tcp://127.0.0.1:5560")`."""

import logging
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Generic, Self, TypeVar

import zmq
import zmq.asyncio

from voltcam_client.encodings import Buffer
from voltcam_client.errors import PacketError, VoltcamError
from voltcam_client.keys import use_keys
from voltcam_client.packet import (
    TOPIC_EVENTS,
    TOPIC_FRAMES,
    FrameMessage,
    Packet,
    decode_frame,
    decode_packet,
)
from voltcam_client.samples import (
    TOPIC_IMU,
    TOPIC_TRIGGERS,
    SamplesMessage,
    decode_imu,
    decode_triggers,
)

DEFAULT_URL = "tcp://127.0.0.1:5560"
KEYS_VARIABLE = "VOLTCAM_KEYS"
TOLD_AFTER_S = 2.0
RECONNECT_MS, SLOWEST_RECONNECT_MS = 100, 1000
KEEPALIVE_IDLE_S, KEEPALIVE_PERIOD_S, KEEPALIVE_PROBES = 2, 1, 3
"""A pulled cable is noticed, and reconnected, after 5 s. By TCP, not by ZeroMQ's heartbeats: with them libzmq
4.3.5 aborts the process when a connection ends while the queue is full (zeromq/libzmq issues 4364, 4767)."""

Message = TypeVar("Message", bound=Packet | FrameMessage | SamplesMessage)
Other = TypeVar("Other", bound=FrameMessage | SamplesMessage)


class Stream(Generic[Message]):
    """The messages of one topic, for `for` and `async for`. It reconnects by itself, for ever.

    - `lost_packets`: messages sent since the first one received here that did not arrive.
    - `restarts`: how often `seq` went back, because the daemon was started again. What is lost between the
      two cannot be known.
    - `latency_us`: how long ago, on this host's clock, the last message was made; None before the first.

    Iterating raises TimeoutError when no message comes for `timeout_s` (None: waits for ever), after which
    it may go on, and PacketError for what is not a message of a Voltcam daemon. One thread at a time.
    """

    def __init__(
        self,
        url: str,
        topic: bytes,
        decode: Callable[[Buffer, Buffer], Message],
        *,
        timeout_s: float | None,
        queue_length: int,
        keys: str | Path | None = None,
    ) -> None:
        self.url = url
        self.keys = keys if keys is not None else os.environ.get(KEYS_VARIABLE) or None
        self.timeout_s = timeout_s
        self.lost_packets = 0
        self.restarts = 0
        self.latency_us: int | None = None
        self._decode = decode
        self._last_seq: int | None = None
        self._socket = _subscribe(url, topic, queue_length, self.keys)
        self._async_socket: zmq.asyncio.Socket | None = None

    def receive(self, timeout_s: float | None = None) -> Message | None:
        """The next message, or None if there is none within `timeout_s` (None: waits for ever)."""
        if not self._socket.poll(_milliseconds(timeout_s)):
            return None
        return self._accept(self._socket.recv_multipart())

    async def receive_async(self, timeout_s: float | None = None) -> Message | None:
        """`receive` for asyncio."""
        if self._async_socket is None:
            self._async_socket = zmq.asyncio.Socket.from_socket(self._socket)
        if not await self._async_socket.poll(_milliseconds(timeout_s)):
            return None
        return self._accept(await self._async_socket.recv_multipart())

    def close(self) -> None:
        """Unsubscribe. Iterating ends."""
        if self._async_socket is not None:
            self._async_socket.close()
        self._socket.close()

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> Message:
        if self._socket.closed:
            raise StopIteration
        message = self.receive(self._first_wait_s)
        if message is None and self._told():
            message = self.receive(self.timeout_s)
        if message is None:
            raise self._timeout()
        return message

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> Message:
        if self._socket.closed:
            raise StopAsyncIteration
        message = await self.receive_async(self._first_wait_s)
        if message is None and self._told():
            message = await self.receive_async(self.timeout_s)
        if message is None:
            raise self._timeout()
        return message

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc_info: object) -> None:
        self.close()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *exc_info: object) -> None:
        self.close()

    def __del__(self) -> None:
        if hasattr(self, "_socket"):  # not when the constructor failed
            self.close()

    @property
    def _first_wait_s(self) -> float | None:
        """Who would wait for ever is told after a while what for."""
        return TOLD_AFTER_S if self.timeout_s is None else self.timeout_s

    def _told(self) -> bool:
        """Say what is waited for; False where the wait is over instead."""
        if self.timeout_s is not None:
            return False
        logging.getLogger("voltcam").warning(
            "nothing from %s for %g s, waiting: is `voltcam serve` running there?", self.url, TOLD_AFTER_S
        )
        return True

    def _timeout(self) -> TimeoutError:
        return TimeoutError(
            f"nothing from {self.url} for {self.timeout_s:g} s: is `voltcam serve` running there?"
        )

    def _accept(self, parts: list[bytes]) -> Message:
        if len(parts) != 3:
            raise PacketError(
                f"{self.url} sent a message of {len(parts)} parts, not 3: is it a Voltcam daemon?"
            )
        _topic, header, buffer = parts
        try:
            message = self._decode(header, buffer)
        except PacketError as error:
            raise PacketError(f"{self.url}: {error}") from error
        self.latency_us = (time.time_ns() - message.stamp_ns) // 1000
        self._count(message.seq)
        return message

    def _count(self, seq: int) -> None:
        if self._last_seq is not None:
            if seq > self._last_seq:
                self.lost_packets += seq - self._last_seq - 1
            else:
                self.restarts += 1
        self._last_seq = seq


class EventCamera(Stream[Packet]):
    """The event packets of the Voltcam daemon at a ZeroMQ address.

    - `url`: `tcp://HOST:PORT`.
    - `timeout_s`: how long iterating waits for a packet; None: for ever.
    - `queue_length`: packets that wait here for a reader slower than the camera. More are dropped, and show
      in `lost_packets`.
    - `keys`: this client's folder made by `voltcam keys`, where the camera uses keys; None: that of
      VOLTCAM_KEYS.

    It is a `Stream` of `Packet`. Raises VoltcamError for an address that is none.
    """

    def __init__(
        self,
        url: str = DEFAULT_URL,
        *,
        timeout_s: float | None = None,
        queue_length: int = 1000,
        keys: str | Path | None = None,
    ) -> None:
        super().__init__(
            url, TOPIC_EVENTS, decode_packet, timeout_s=timeout_s, queue_length=queue_length, keys=keys
        )

    def frames(self, *, queue_length: int = 30) -> Stream[FrameMessage]:
        """The frames that the camera sees, over a connection of their own."""
        return self._beside(TOPIC_FRAMES, decode_frame, queue_length)

    def imu(self, *, queue_length: int = 1000) -> Stream[SamplesMessage]:
        """The samples of its IMU, where it has one, over a connection of their own."""
        return self._beside(TOPIC_IMU, decode_imu, queue_length)

    def triggers(self, *, queue_length: int = 1000) -> Stream[SamplesMessage]:
        """Its triggers, where it has some, over a connection of their own."""
        return self._beside(TOPIC_TRIGGERS, decode_triggers, queue_length)

    def _beside(
        self, topic: bytes, decode: Callable[[Buffer, Buffer], Other], queue_length: int
    ) -> Stream[Other]:
        return Stream(
            self.url, topic, decode, timeout_s=self.timeout_s, queue_length=queue_length, keys=self.keys
        )


def _subscribe(url: str, topic: bytes, queue_length: int, keys: str | Path | None) -> zmq.SyncSocket:
    socket: zmq.SyncSocket = zmq.Context.instance().socket(zmq.SUB)
    socket.linger = 0
    socket.rcvhwm = queue_length
    socket.reconnect_ivl = RECONNECT_MS
    socket.reconnect_ivl_max = SLOWEST_RECONNECT_MS
    socket.tcp_keepalive = 1
    socket.tcp_keepalive_idle = KEEPALIVE_IDLE_S
    socket.tcp_keepalive_intvl = KEEPALIVE_PERIOD_S
    socket.tcp_keepalive_cnt = KEEPALIVE_PROBES
    socket.ipv6 = "[" in url  # not always: localhost would be ::1 then, where a daemon seldom listens
    socket.subscribe(topic)
    try:
        if keys is not None:
            use_keys(socket, Path(keys))
        socket.connect(url)
    except VoltcamError:
        socket.close()
        raise
    except zmq.ZMQError as error:
        socket.close()
        raise VoltcamError(f"cannot subscribe to {url!r} ({error.strerror}): give tcp://HOST:PORT") from error
    return socket


def _milliseconds(timeout_s: float | None) -> int:
    return -1 if timeout_s is None else max(0, round(1000 * timeout_s))
