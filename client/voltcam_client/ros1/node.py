"""A node: known to a roscore, called by it and by other nodes, for as long as both are there."""

import contextlib
import os
import socket
import threading
from typing import Any, Self

from voltcam_client.ros1 import RosError
from voltcam_client.ros1.message_types import message_type
from voltcam_client.ros1.names import Names, bind_address
from voltcam_client.ros1.publication import Publication
from voltcam_client.ros1.subscription import Subscription
from voltcam_client.ros1.tcpros import encode_fields, receive_fields
from voltcam_client.ros1.xml_rpc import RpcServer, call

HANDSHAKE_S = 5.0
HANDSHAKES_AT_ONCE = 16
WATCH_S, MISSED = 1.0, 3
"""The roscore is asked so often whether it is there; so many times without an answer, it is not."""


class Node:
    """A context manager. ended: why it is over, for `check`.

    Raises RosError where there is no roscore.
    """

    def __init__(self, names: Names) -> None:
        self.names = names
        self._publications: dict[str, Publication] = {}
        self._subscriptions: dict[str, Subscription] = {}
        self._ended: str | None = None
        self._stop = threading.Event()
        self._handshakes = threading.BoundedSemaphore(HANDSHAKES_AT_ONCE)
        self._master_pid = self._greet()
        host = names.own_host()
        self._listener: socket.socket | None = None  # of subscribers
        self._server = RpcServer(bind_address(host), self._methods())
        self._host, self.uri = host, f"http://{host}:{self._server.port}/"
        threading.Thread(target=self._watch, name="voltcam-ros1-watch", daemon=True).start()

    def advertise(self, topic: str, kind: str, queue_size: int) -> Publication:
        """Publish a topic of this type from now on. Raises RosError."""
        whole = self.names.resolved(topic)
        publication = Publication(self.names.node, whole, message_type(kind), queue_size)
        self._publications[whole] = publication
        if self._listener is None:
            self._listener = socket.create_server((bind_address(self._host), 0))
            accept = threading.Thread(target=self._accept, args=(self._listener,), daemon=True)
            accept.start()
        self._ask("registerPublisher", whole, kind, self.uri)
        return publication

    def subscribe(self, topic: str, kinds: tuple[str, ...], queue_size: int, most_bytes: int) -> Subscription:
        """Receive a topic that has one of these types. Raises RosError."""
        whole = self.names.resolved(topic)
        types = tuple(map(message_type, kinds))
        subscription = Subscription(self.names.node, whole, types, queue_size, most_bytes)
        self._subscriptions[whole] = subscription
        subscription.update(self._ask("registerSubscriber", whole, "*", self.uri))
        return subscription

    def check(self) -> None:
        """Raises RosError where the roscore has ended, or has told this node to end."""
        if self._ended is not None:
            raise RosError(self._ended)

    def close(self) -> None:
        """Leave: the roscore is told, and all connections end."""
        if self._stop.is_set():
            return
        self._stop.set()
        with contextlib.suppress(RosError):  # a roscore that has gone
            for topic in self._publications:
                self._ask("unregisterPublisher", topic, self.uri)
            for topic in self._subscriptions:
                self._ask("unregisterSubscriber", topic, self.uri)
        if self._listener is not None:
            with contextlib.suppress(OSError):
                self._listener.shutdown(socket.SHUT_RDWR)  # wakes `accept`
            self._listener.close()
        self._server.close()
        for publication in self._publications.values():
            publication.close()
        for subscription in self._subscriptions.values():
            subscription.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc_info: object) -> None:
        self.close()

    def _ask(self, method: str, *arguments: Any) -> Any:
        return call(self.names.master, method, self.names.node, *arguments)

    def _greet(self) -> Any:
        try:
            return self._ask("getPid")
        except RosError as error:
            remedy = "start one (apt install ros-core), or set ROS_MASTER_URI"
            raise RosError(f"no roscore ({error}): {remedy}") from None

    def _watch(self) -> None:
        """A roscore that was started again does not know this node."""
        missed = 0
        while not self._stop.wait(WATCH_S) and self._ended is None:
            try:
                missed = 0 if self._ask("getPid") == self._master_pid else MISSED
            except RosError:
                missed += 1
            if missed >= MISSED:
                self._ended = f"the roscore at {self.names.master} has ended: start it, and then this again"

    def _accept(self, listener: socket.socket) -> None:
        while not self._stop.is_set():
            try:
                connection, _ = listener.accept()
            except OSError:
                if self._stop.wait(WATCH_S):  # closed; else too many files are open
                    return
                continue
            if not self._handshakes.acquire(blocking=False):
                connection.close()
                continue
            threading.Thread(target=self._meet, args=(connection,), daemon=True).start()

    def _meet(self, connection: socket.socket) -> None:
        """A subscriber says what it wants, and gets it, or the reason why not."""
        try:
            fields = receive_fields(connection, HANDSHAKE_S)
            connection.settimeout(None)
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            publication = self._publications.get(fields.get("topic", ""))
            if publication is None:
                raise RosError(f"{self.names.node} does not publish {fields.get('topic', 'that')[:80]}")
            publication.connect(connection, fields)
        except (RosError, OSError, EOFError) as error:
            with contextlib.suppress(OSError):
                connection.sendall(encode_fields({"error": str(error)}))
            connection.close()
        finally:
            self._handshakes.release()

    def _methods(self) -> dict[str, Any]:
        """What others call; each begins with the caller's name."""
        return {
            "getBusStats": lambda caller: [[], [], []],
            "getBusInfo": lambda caller: self._bus(),
            "getMasterUri": lambda caller: self.names.master,
            "getPid": lambda caller: os.getpid(),
            "getPublications": lambda caller: [[p.topic, p.kind.name] for p in self._publications.values()],
            "getSubscriptions": lambda caller: [[s.topic, "*"] for s in self._subscriptions.values()],
            "paramUpdate": lambda caller, key, value: 0,
            "publisherUpdate": self._publisher_update,
            "requestTopic": self._request_topic,
            "shutdown": self._shut_down,
        }

    def _bus(self) -> list[list[Any]]:
        """[number, the other node, direction, protocol, topic, connected] of each connection."""
        links = [(name, "o", p.topic) for p in self._publications.values() for name in p.subscribers]
        links += [(uri, "i", s.topic) for s in self._subscriptions.values() for uri in s.publishers]
        return [[n, other, way, "TCPROS", topic, True] for n, (other, way, topic) in enumerate(links)]

    def _publisher_update(self, caller: str, topic: str, uris: list[str]) -> int:
        subscription = self._subscriptions.get(topic)
        if subscription is not None:
            subscription.update(uris)
        return 0

    def _request_topic(self, caller: str, topic: str, protocols: list[list[Any]]) -> list[Any]:
        if topic not in self._publications or self._listener is None:
            raise ValueError(f"{self.names.node} does not publish that")
        if not any(protocol[:1] == ["TCPROS"] for protocol in protocols):
            raise ValueError("TCPROS only")
        return ["TCPROS", self._host, self._listener.getsockname()[1]]

    def _shut_down(self, caller: str, reason: str = "") -> int:
        """As a roscore does where a second node has this name, and `rosnode kill`."""
        self._ended = f"{self.names.node} was told to end: {' '.join(str(reason)[:200].split())}"
        return 0
