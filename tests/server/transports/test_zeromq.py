"""ZeroMQ: what subscribers get, and what a bad one costs."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial

import msgpack
import numpy as np
import pytest
import zmq

from voltcam_client.packet import EVENT, FrameMessage, Packet, decode_frame, decode_packet
from voltcam_server.messages import Message, events_message, frame_message, status_message
from voltcam_server.problems import UsageError
from voltcam_server.transports import ZeroMQTransport
from voltcam_server.transports.zeromq import MOST_TOPICS

from ..rig import PATIENCE_S, until


def packet(seq: int, count: int = 10) -> Packet:
    events = np.zeros(count, EVENT)
    events["x"] = seq % 100
    return Packet(events=events, width=128, height=128, seq=seq, time_base_ns=0, stamp_ns=1)


@pytest.fixture
def transport() -> Iterator[ZeroMQTransport]:
    transport = ZeroMQTransport("tcp://127.0.0.1:0", "libcaer")
    transport.start()
    yield transport
    transport.stop()


@pytest.fixture
def subscriber(transport: ZeroMQTransport) -> Iterator[Callable[..., zmq.SyncSocket]]:
    """Connects subscribers, which are closed at the end."""
    with contextlib.ExitStack() as stack:
        context = stack.enter_context(zmq.Context())

        def connect(topic: bytes = b"", queue: int = 1000, kind: int = zmq.SUB) -> zmq.SyncSocket:
            socket = stack.enter_context(context.socket(kind))
            socket.linger = 0
            socket.rcvtimeo = int(1000 * PATIENCE_S)
            socket.rcvhwm = queue
            socket.connect(transport.endpoint)
            if kind == zmq.SUB:
                socket.subscribe(topic)
                settle(socket, transport)
            return socket

        yield connect


def settle(socket: zmq.SyncSocket, transport: ZeroMQTransport) -> None:
    """Publish until this socket gets it: then its subscription is in force."""
    while not socket.poll(20):
        transport.publish(events_message(packet(0)))
    while socket.poll(100):
        socket.recv_multipart()


def test_all_topics_arrive_as_the_contract_says(
    transport: ZeroMQTransport, subscriber: Callable[..., zmq.SyncSocket]
) -> None:
    socket = subscriber()
    image = np.arange(6, dtype=np.uint8).reshape(2, 3)
    transport.publish(events_message(packet(7)))
    transport.publish(frame_message(FrameMessage(image=image, seq=3, t_us=5, stamp_ns=1)))
    transport.publish(status_message({"uptime_s": 1.5}))
    topic, header, buffer = socket.recv_multipart()
    received = decode_packet(header, buffer)
    assert (topic, received.seq, received.encoding) == (b"events", 7, "libcaer")
    np.testing.assert_array_equal(received.events, packet(7).events)
    topic, header, buffer = socket.recv_multipart()
    assert topic == b"frames"
    np.testing.assert_array_equal(decode_frame(header, buffer).image, image)
    assert [socket.recv() for _ in range(2)] == [b"status", msgpack.packb({"uptime_s": 1.5})]
    assert not socket.get(zmq.RCVMORE)


def test_what_nobody_subscribes_to_is_not_encoded(
    transport: ZeroMQTransport, subscriber: Callable[..., zmq.SyncSocket]
) -> None:
    socket = subscriber(b"events")

    def never(_: str) -> tuple[bytes, ...]:
        raise AssertionError("encoded for nobody")

    transport.publish(Message(b"frames", 100, never))
    transport.publish(events_message(packet(1)))
    assert socket.recv_multipart()[0] == b"events"  # the thread has come past the frame, and lives


def test_a_subscriber_that_never_reads_costs_only_itself(
    transport: ZeroMQTransport, subscriber: Callable[..., zmq.SyncSocket]
) -> None:
    """2500 messages of 64 KB: the reader gets all of them, the other what its queues hold, about 1000."""
    total, window = 2500, 200
    dead = subscriber(queue=1)
    reader = subscriber(queue=0)
    room = threading.Semaphore(window)  # as a camera, the publisher does not outrun who reads
    buffer = bytes(65536)

    def publish() -> None:
        for seq in range(total):
            assert room.acquire(timeout=PATIENCE_S)
            parts = (seq.to_bytes(4, "little"), buffer)
            transport.publish(Message(b"events", 65536, partial(lambda parts, _: parts, parts)))

    publisher = threading.Thread(target=publish)
    publisher.start()
    for seq in range(total):
        assert int.from_bytes(reader.recv_multipart()[1], "little") == seq
        room.release()
    publisher.join()
    late = 0
    while dead.poll(200):
        dead.recv_multipart()
        late += 1
    assert 0 < late < total - 500
    assert transport.status.packets_dropped == 0  # of the outbox


def test_an_outbox_that_overflows_drops_the_oldest_and_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voltcam_server.transports.transport.OUTBOX_BYTES", 1000)
    transport = ZeroMQTransport("tcp://127.0.0.1:0", "libcaer")
    for _ in range(10):  # its thread does not run
        transport.publish(Message(b"events", 300, lambda _: ()))
    assert transport.status.packets_dropped == 7
    transport.stop()


def test_a_subscriber_that_vanishes_does_no_harm(
    transport: ZeroMQTransport, subscriber: Callable[..., zmq.SyncSocket]
) -> None:
    socket = subscriber()
    socket.close(linger=0)
    other = subscriber()
    transport.publish(events_message(packet(5)))
    assert decode_packet(*other.recv_multipart()[1:]).seq == 5


def test_what_a_subscriber_sends_is_ignored(
    transport: ZeroMQTransport, subscriber: Callable[..., zmq.SyncSocket]
) -> None:
    rude = subscriber(kind=zmq.XSUB)
    rude.send(b"\1")
    rude.send(b"no subscription")
    rude.send(b"")
    settle(rude, transport)
    until(lambda: transport.status.packets_sent > 0, "it sends on")


def test_a_port_in_use_is_said_with_the_flag(transport: ZeroMQTransport) -> None:
    with pytest.raises(UsageError) as caught:
        ZeroMQTransport(transport.endpoint, "libcaer")
    assert transport.endpoint in str(caught.value)
    assert "in use" in str(caught.value)
    assert "--zmq" in str(caught.value)


def test_subscriptions_without_end_are_let_go_of(
    transport: ZeroMQTransport,
    subscriber: Callable[..., zmq.SyncSocket],
    caplog: pytest.LogCaptureFixture,
) -> None:
    """200 subscribers with 500 topics of 480 bytes each took 2.7 GB, and nobody got a packet after that."""
    good = subscriber(b"events")
    with zmq.Context() as context:
        context.max_sockets = 100
        floods = [context.socket(zmq.SUB) for _ in range(20)]
        for number, flood in enumerate(floods):
            flood.linger = 0
            flood.connect(transport.endpoint)
            for topic in range(MOST_TOPICS // 10):
                flood.subscribe(b"%d-%d-" % (number, topic) + b"x" * 40)
        began_s = time.monotonic()
        while time.monotonic() - began_s < 2:
            transport.publish(events_message(packet(1)))
            time.sleep(0.001)
        for flood in floods:
            flood.close()
    assert "all subscribers are let go" in caplog.text
    settle(good, transport)
    transport.publish(events_message(packet(7)))
    assert decode_packet(*good.recv_multipart()[1:]).seq == 7
    assert transport.failure is None
