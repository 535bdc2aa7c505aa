"""A tiny daemon: an XPUB socket on 127.0.0.1."""

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import zmq

from voltcam_client import EventCamera
from voltcam_client.packet import (
    EVENT,
    TOPIC_EVENTS,
    TOPIC_FRAMES,
    FrameMessage,
    Packet,
    encode_frame,
    encode_packet,
)

WIDTH, HEIGHT = 40, 30


def make_packet(seq: int, n: int = 10, *, width: int = WIDTH, t_us: int | None = None) -> Packet:
    """Packet `seq` of a camera that makes one per ms: n events, one in four ON."""
    t_us = 1000 * seq if t_us is None else t_us
    events = np.zeros(n, EVENT)
    events["t"] = t_us
    events["x"] = np.arange(n) % width
    events["p"] = np.arange(n) % 4 == 0
    return Packet(
        events=events,
        height=HEIGHT,
        width=width,
        seq=seq,
        time_base_ns=1000 * t_us,
        stamp_ns=time.time_ns(),
        dropped=7,
        parameters_version=3,
    )


def make_frame(seq: int) -> FrameMessage:
    image = np.full((HEIGHT, WIDTH), seq % 256, np.uint8)
    return FrameMessage(image=image, seq=seq, t_us=1000 * seq, stamp_ns=time.time_ns())


class Publisher:
    """Publishes at a free port of a host, or at `port`."""

    def __init__(self, port: int = 0, queue_length: int = 1000, host: str = "127.0.0.1") -> None:
        self._socket = zmq.Context.instance().socket(zmq.XPUB)
        self._subscriptions: Counter[bytes] = Counter()  # seen and not yet waited for
        self._socket.linger = 0
        self._socket.sndhwm = queue_length
        self._socket.xpub_verboser = True
        self._socket.ipv6 = ":" in host
        self._bind(f"tcp://{host}:{port or '*'}")
        self.url = self._socket.last_endpoint.decode()
        self.port = int(self.url.rpartition(":")[2])

    def _bind(self, url: str) -> None:
        """ZeroMQ gives a port back some time after close(), without a word."""
        deadline = time.monotonic() + 10
        while True:
            try:
                self._socket.bind(url)
                return
            except zmq.ZMQError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.01)

    def wait_for_subscribers(
        self, topic: bytes = TOPIC_EVENTS, count: int = 1, client: EventCamera | None = None
    ) -> None:
        """Wait until `count` have subscribed. After a reconnection a client does so only while it receives:
        then name it, and it is made to."""
        deadline = time.monotonic() + 10
        while self._subscriptions[b"\x01" + topic] < count:
            assert time.monotonic() < deadline, "nobody subscribed"
            if client is not None:
                assert client.receive(0) is None
            if self._socket.poll(20):
                self._subscriptions[self._socket.recv()] += 1
        self._subscriptions[b"\x01" + topic] -= count

    def send(self, *messages: Packet | FrameMessage) -> None:
        for message in messages:
            if isinstance(message, Packet):
                self.send_raw(TOPIC_EVENTS, *encode_packet(message))
            else:
                self.send_raw(TOPIC_FRAMES, *encode_frame(message))

    def send_raw(self, *parts: bytes) -> None:
        self._socket.send_multipart(parts)

    def close(self) -> None:
        self._socket.close()


@pytest.fixture
def publish() -> Iterator[Callable[..., Publisher]]:
    """publish(port=0, queue_length=1000): a Publisher, closed after the test."""
    publishers: list[Publisher] = []

    def make(**options: Any) -> Publisher:
        publishers.append(Publisher(**options))
        return publishers[-1]

    yield make
    for publisher in publishers:
        publisher.close()


@pytest.fixture
def publisher(publish: Callable[..., Publisher]) -> Publisher:
    return publish()


@pytest.fixture(name="make_packet")
def _make_packet() -> Callable[..., Packet]:
    return make_packet


@pytest.fixture(name="make_frame")
def _make_frame() -> Callable[..., FrameMessage]:
    return make_frame


@pytest.fixture
def running_camera() -> Iterator[str]:
    """The URL of a camera that sends a packet and a frame every ms or so, whether or not anyone listens."""
    ready, stop = threading.Event(), threading.Event()
    urls = []

    def run() -> None:
        publisher = Publisher()
        urls.append(publisher.url)
        ready.set()
        seq = 0
        while not stop.wait(0.001):
            publisher.send(make_packet(seq), make_frame(seq))
            seq += 1
        publisher.close()

    thread = threading.Thread(target=run)
    thread.start()
    assert ready.wait(10)
    yield urls[0]
    stop.set()
    thread.join(10)
