"""Nodes that talk to each other, and to those who do not speak ROS 1."""

import contextlib
import socket
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from tests.client.ros1.master import Master, mastering

from voltcam_client.ros1 import RosError, node
from voltcam_client.ros1.message_types import message_type
from voltcam_client.ros1.names import Names
from voltcam_client.ros1.node import Node
from voltcam_client.ros1.subscription import Received, Subscription
from voltcam_client.ros1.tcpros import encode_fields, receive_fields, receive_message
from voltcam_client.ros1.xml_rpc import call

IMAGE, CLOCK = "sensor_msgs/Image", "rosgraph_msgs/Clock"


@pytest.fixture
def master() -> Iterator[Master]:
    with mastering() as running:
        yield running


def until(condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def next_of(subscription: Subscription) -> bytes:
    message = subscription.receive(20)
    assert message is not None
    return message[1]


@pytest.mark.parametrize("first", ["publisher", "subscriber"])
def test_one_publishes_and_another_receives(master: Master, first: str) -> None:
    with Node(master.names("a")) as one, Node(master.names("b")) as other:
        if first == "subscriber":
            subscription = other.subscribe("clock", (CLOCK,), 10, 100)
        publication = one.advertise("clock", CLOCK, 10)
        if first == "publisher":
            subscription = other.subscribe("clock", (CLOCK,), 10, 100)
        until(lambda: publication.wanted)
        for number in range(5):
            publication.publish(bytes([number] * 8))
        came = [subscription.receive(20) for _ in range(5)]
        assert came == [(CLOCK, bytes([number] * 8), 0) for number in range(5)]
        assert call(one.uri, "getPublications", "/t") == [["/clock", CLOCK]]
        assert call(other.uri, "getSubscriptions", "/t") == [["/clock", "*"]]
        assert [link[1:] for link in call(one.uri, "getBusInfo", "/t")] == [
            ["/b", "o", "TCPROS", "/clock", True]
        ]
    assert not master.publishers["/clock"]
    assert not master.subscribers["/clock"]


def test_a_publisher_that_comes_again_is_received_again(master: Master) -> None:
    with Node(master.names("b")) as other:
        subscription = other.subscribe("clock", (CLOCK,), 10, 100)
        for number in range(2):
            with Node(master.names("a")) as one:
                publication = one.advertise("clock", CLOCK, 10)
                until(lambda: publication.wanted)  # noqa: B023
                publication.publish(bytes([number] * 8))
                assert next_of(subscription) == bytes([number] * 8)


def test_publishers_that_died_are_in_nobody_s_way(master: Master) -> None:
    """A roscore keeps them, and names them first."""
    master.publishers["/clock"] += [f"http://127.0.0.1:{port}/" for port in range(1, 41)]
    with Node(master.names("b")) as other, Node(master.names("a")) as one:
        subscription = other.subscribe("clock", (CLOCK,), 10, 100)
        publication = one.advertise("clock", CLOCK, 10)
        until(lambda: publication.wanted)
        publication.publish(bytes(8))
        assert next_of(subscription) == bytes(8)


def test_of_what_is_not_taken_the_oldest_goes(master: Master) -> None:
    with Node(master.names("a")) as one, Node(master.names("b")) as other:
        publication = one.advertise("clock", CLOCK, 100)
        subscription = other.subscribe("clock", (CLOCK,), 2, 100)
        until(lambda: publication.wanted)
        for number in range(10):
            publication.publish(bytes([number] * 8))
        until(lambda: len(subscription._queue) == 2 and subscription._dropped == 8)
        assert subscription.receive(1) == (CLOCK, bytes([8] * 8), 8)
        assert subscription.receive(1) == (CLOCK, bytes([9] * 8), 0)
        assert subscription.receive(0.01) is None


def raw_subscriber(uri: str, topic: str, **fields: str) -> socket.socket:
    _, host, port = call(uri, "requestTopic", "/raw", topic, [["TCPROS"]])
    connection = socket.create_connection((host, port), 10)
    connection.sendall(encode_fields({"callerid": "/raw", "topic": topic} | fields))
    return connection


def test_who_stalls_costs_only_itself(master: Master) -> None:
    body, count = bytes(1_000_000), 60
    with Node(master.names("a")) as one, Node(master.names("b")) as other:
        publication = one.advertise("image", IMAGE, 5)
        with raw_subscriber(one.uri, "/image", type="*", md5sum="*"):
            subscription = other.subscribe("image", (IMAGE,), 5, 10_000_000)
            until(lambda: len(publication.subscribers) == 2)
            for _ in range(count):
                publication.publish(body)
                assert next_of(subscription) == body
            until(lambda: publication.dropped > count // 2)
        until(lambda: publication.subscribers == ["/b"])
        assert publication.dropped > count // 2


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"type": "std_msgs/String", "md5sum": "*"}, "has type sensor_msgs/Image, not std_msgs/String"),
        ({"type": IMAGE, "md5sum": "0"}, "has md5sum 0600"),
        ({"type": IMAGE}, "not None"),
    ],
)
def test_who_wants_another_type_is_told(master: Master, fields: dict[str, str], words: str) -> None:
    with Node(master.names("a")) as one:
        one.advertise("image", IMAGE, 5)
        with raw_subscriber(one.uri, "/image", **fields) as connection:
            assert words in receive_fields(connection, 10)["error"]


def test_a_topic_of_another_type_is_said(master: Master) -> None:
    with Node(master.names("a")) as one, Node(master.names("b")) as other:
        one.advertise("image", CLOCK, 5)
        subscription = other.subscribe("image", (IMAGE, "sensor_msgs/CompressedImage"), 5, 100)
        with pytest.raises(
            RosError, match=r"/image is of type rosgraph_msgs/Clock: give a topic of sensor_msgs/Image or"
        ):
            subscription.receive(20)


def test_garbage_at_the_ports_does_no_harm(master: Master) -> None:
    rng = np.random.default_rng(9)
    with Node(master.names("a")) as one, Node(master.names("b")) as other:
        publication = one.advertise("clock", CLOCK, 5)
        _, host, port = call(one.uri, "requestTopic", "/raw", "/clock", [["TCPROS"]])
        attempts = [b"", b"\xff\xff\xff\xff", b"\4\0\0\0\xff\0\0\0", encode_fields({"topic": "/none"})]
        for attempt in [*attempts, *(rng.bytes(100) for _ in range(30))]:
            with socket.create_connection((host, port), 10) as connection, contextlib.suppress(OSError):
                connection.sendall(attempt)
                connection.shutdown(socket.SHUT_WR)
                while connection.recv(1000):
                    pass
        subscription = other.subscribe("clock", (CLOCK,), 5, 100)
        until(lambda: publication.wanted)
        publication.publish(bytes(8))
        assert next_of(subscription) == bytes(8)


def test_those_who_say_nothing_are_let_go(master: Master, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node, "HANDSHAKE_S", 0.3)
    with Node(master.names("a")) as one, Node(master.names("b")) as other:
        publication = one.advertise("clock", CLOCK, 5)
        _, host, port = call(one.uri, "requestTopic", "/raw", "/clock", [["TCPROS"]])
        idle = [socket.create_connection((host, port), 10) for _ in range(40)]
        other.subscribe("clock", (CLOCK,), 5, 100)
        until(lambda: publication.wanted)
        for connection in idle:
            connection.settimeout(10)
            with contextlib.suppress(ConnectionResetError):
                while connection.recv(1000):
                    pass
            connection.close()


class BadPublisher:
    """Says these bytes to who subscribes, after the greeting that it should."""

    def __init__(self, master: Master, topic: str) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._node = Node(master.names("bad"))
        self._node.advertise(topic, IMAGE, 1)
        self._node._listener.close()
        self._node._listener = self._listener

    def say(self, data: bytes, *, greet: bool = True) -> None:
        connection, _ = self._listener.accept()
        with connection, contextlib.suppress(OSError):
            receive_fields(connection, 10)
            if greet:
                kind = message_type(IMAGE)
                connection.sendall(encode_fields({"type": kind.name, "md5sum": kind.md5}))
            connection.sendall(data)

    def close(self) -> None:
        self._node.close()


@pytest.mark.parametrize(
    ("said", "greet", "words"),
    [
        (b"\xff\xff\xff\xff", True, "a message of 4294967295 bytes, of which 1000 are taken"),
        (b"\x64\0\0\0abc", True, "a message of 100 bytes was cut short"),
        (b"\xff\xff\xff\xff", False, "a message of 4294967295 bytes"),
        (b"\4\0\0\0abcd", False, "no list of KEY=VALUE"),
        (encode_fields({"error": "not you"}), False, "its publisher says not you"),
        (encode_fields({}), False, "is of type none"),
    ],
)
def test_what_a_publisher_says_that_is_none(master: Master, said: bytes, greet: bool, words: str) -> None:
    """It is said in a line, and the next message is received."""
    bad = BadPublisher(master, "image")
    try:
        with Node(master.names("b")) as other:
            subscription = other.subscribe("image", (IMAGE,), 5, 1000)
            bad.say(said, greet=greet)
            with pytest.raises(RosError, match=words) as caught:
                subscription.receive(20)
            assert "\n" not in str(caught.value)
            bad.say(b"\3\0\0\0abc")
            deadline = time.monotonic() + 20
            while (message := _quietly(subscription)) is None:
                assert time.monotonic() < deadline
            assert message == (IMAGE, b"abc", 0)
    finally:
        bad.close()


def _quietly(subscription: Subscription) -> Received | None:
    with contextlib.suppress(RosError):
        return subscription.receive(0.1)
    return None


def test_a_roscore_that_ends_or_begins_again_ends_the_node(
    master: Master, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node, "WATCH_S", 0.02)
    with Node(master.names("a")) as one:
        one.check()
        master.pid = 2
        with pytest.raises(RosError, match="has ended: start it"):
            until(lambda: one.check())
    with Node(master.names("a")) as one:
        master.close()
        with pytest.raises(RosError, match="has ended: start it"):
            until(lambda: one.check())


def test_it_ends_where_another_has_its_name(master: Master) -> None:
    with Node(master.names("a")) as one:
        call(one.uri, "shutdown", "/master", "new node registered with same name")
        with pytest.raises(RosError, match="/a was told to end: new node registered"):
            one.check()


def test_without_a_roscore() -> None:
    with pytest.raises(
        RosError, match=r"no roscore \(nobody answers .*\): start one \(apt install ros-core\)"
    ):
        Node(Names.of("a", [], {"ROS_MASTER_URI": "http://127.0.0.1:1"}))


def test_the_map_that_a_subscriber_gets(master: Master) -> None:
    with Node(master.names("a")) as one:
        publication = one.advertise("clock", CLOCK, 5)
        with raw_subscriber(one.uri, "/clock", type="*", md5sum="*") as connection:
            fields = receive_fields(connection, 10)
            kind = message_type(CLOCK)
            assert (fields["type"], fields["md5sum"], fields["topic"]) == (CLOCK, kind.md5, "/clock")
            assert fields["message_definition"] == kind.definition
            until(lambda: publication.wanted)
            publication.publish(b"12345678")
            assert receive_message(connection, 8) == b"12345678"
