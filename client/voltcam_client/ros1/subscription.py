"""A topic that this node receives, from all who publish it; a few messages wait, the oldest is dropped."""

import contextlib
import socket
import threading
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from voltcam_client.ros1 import RosError
from voltcam_client.ros1.message_types import MessageType
from voltcam_client.ros1.tcpros import encode_fields, receive_fields, receive_message
from voltcam_client.ros1.xml_rpc import call

CONNECT_S = 5.0
AGAIN_S, LONGEST_AGAIN_S = 0.1, 2.0
MOST_PUBLISHERS = 16
"""The newest: a roscore keeps those that died, and names them first."""


class Received(NamedTuple):
    """kind: the name of its type. body: as it came. dropped: how many were since the one before."""

    kind: str
    body: bytes
    dropped: int


class Subscription:
    """publishers: the addresses of the nodes that it is connected with, or will be."""

    def __init__(
        self, node: str, topic: str, kinds: Sequence[MessageType], queue_size: int, most_bytes: int
    ) -> None:
        self.topic = topic
        self._node, self._kinds, self._most_bytes = node, {kind.name: kind for kind in kinds}, most_bytes
        self._queue: deque[tuple[str, bytes]] = deque(maxlen=queue_size)
        self._dropped = 0
        self._links: dict[str, _Link] = {}
        self._fault: RosError | None = None
        self._closed = False
        self._changed = threading.Condition()

    @property
    def publishers(self) -> list[str]:
        return list(self._links)

    def receive(self, timeout_s: float) -> Received | None:
        """The oldest message that waits; None where none comes within that time.

        Raises RosError once for what a publisher said that is wrong.
        """
        with self._changed:
            if not self._queue and self._fault is None:
                self._changed.wait(timeout_s)
            if self._queue:
                dropped, self._dropped = self._dropped, 0
                return Received(*self._queue.popleft(), dropped)
            fault, self._fault = self._fault, None
        if fault is not None:
            raise fault
        return None

    def update(self, uris: Sequence[str]) -> None:
        """These nodes publish it, as the roscore says."""
        wanted = [uri for uri in dict.fromkeys(uris) if isinstance(uri, str)][-MOST_PUBLISHERS:]
        with self._changed:
            for uri in set(self._links) - set(wanted):
                self._links.pop(uri).close()
            for uri in wanted:
                if uri not in self._links and not self._closed:
                    self._links[uri] = _Link(self, uri)

    def close(self) -> None:
        with self._changed:
            self._closed = True
            for link in self._links.values():
                link.close()
            self._links.clear()
            self._changed.notify_all()

    def put(self, kind: str, body: bytes) -> None:
        """A message that came."""
        with self._changed:
            self._dropped += len(self._queue) == self._queue.maxlen
            self._queue.append((kind, body))
            self._changed.notify()

    def fail(self, fault: RosError) -> None:
        """Something wrong that came."""
        with self._changed:
            self._fault = fault
            self._changed.notify()

    def connected(self, uri: str) -> tuple[socket.socket, str]:
        """A connection to a publisher that says a type of ours, and that type.

        Raises RosError for what it says, OSError where it is not there, which a roscore may not know.
        """
        try:
            offer = call(uri, "requestTopic", self._node, self.topic, [["TCPROS"]])
        except RosError as error:
            raise OSError(str(error)) from None
        if not (
            isinstance(offer, list)
            and [type(part) for part in offer[:3]] == [str, str, int]
            and offer[0] == "TCPROS"
            and 0 < offer[2] < 65536
        ):
            raise RosError(f"{uri} does not offer {self.topic} over TCPROS")
        connection = socket.create_connection((offer[1], offer[2]), CONNECT_S)
        try:
            return connection, self._agreed(connection)
        except BaseException:
            connection.close()
            raise

    def receive_from(self, connection: socket.socket) -> bytes:
        """The next message. Raises RosError, EOFError, OSError."""
        return receive_message(connection, self._most_bytes)

    def _agreed(self, connection: socket.socket) -> str:
        """The type, after the greeting."""
        ours = {"callerid": self._node, "md5sum": "*", "tcp_nodelay": "1", "topic": self.topic, "type": "*"}
        connection.sendall(encode_fields(ours))
        theirs = receive_fields(connection, CONNECT_S)
        if "error" in theirs:
            raise RosError(f"{self.topic}: its publisher says {theirs['error'][:200]}")
        kind = self._kinds.get(theirs.get("type", ""))
        if kind is None or theirs.get("md5sum") != kind.md5:
            taken = " or ".join(self._kinds)
            raise RosError(
                f"{self.topic} is of type {theirs.get('type', 'none')[:80]}: give a topic of {taken}"
            )
        connection.settimeout(None)
        return kind.name


class _Link:
    """One publisher, connected again for as long as the roscore knows it."""

    def __init__(self, of: Subscription, uri: str) -> None:
        self._of, self._uri = of, uri
        self._left = threading.Event()
        self._connection: socket.socket | None = None
        threading.Thread(target=self._run, name="voltcam-ros1-publisher", daemon=True).start()

    def close(self) -> None:
        self._left.set()
        if self._connection is not None:
            with contextlib.suppress(OSError):
                self._connection.shutdown(socket.SHUT_RDWR)

    def _run(self) -> None:
        wait_s = AGAIN_S
        while not self._left.is_set():
            try:
                connection, kind = self._of.connected(self._uri)
                self._connection = connection
                with contextlib.closing(connection):
                    while not self._left.is_set():
                        self._of.put(kind, self._of.receive_from(connection))
                        wait_s = AGAIN_S
            except RosError as error:
                self._of.fail(error)
            except (OSError, EOFError):
                pass  # the node has ended, or its machine is not there: the roscore will say so
            self._left.wait(wait_s)
            wait_s = min(2 * wait_s, LONGEST_AGAIN_S)
