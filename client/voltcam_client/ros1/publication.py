"""A topic that this node publishes: to each subscriber from a queue of its own, which drops the oldest."""

import contextlib
import socket
import threading
from collections import deque

from voltcam_client.ros1 import RosError
from voltcam_client.ros1.message_types import MessageType
from voltcam_client.ros1.tcpros import encode_fields

MOST_SUBSCRIBERS = 32
ANY = "*"


class Publication:
    """dropped: messages that a subscriber was too slow for. next_sequence: of a message's header."""

    def __init__(self, node: str, topic: str, kind: MessageType, queue_size: int) -> None:
        self.topic, self.kind = topic, kind
        self.next_sequence = 0
        self._queue_size = queue_size
        self._fields = {
            "callerid": node,
            "latching": "0",
            "md5sum": kind.md5,
            "message_definition": kind.definition,
            "topic": topic,
            "type": kind.name,
        }
        self._links: list[_Link] = []
        self._dropped_before = 0
        self._lock = threading.Lock()

    @property
    def wanted(self) -> bool:
        """Whether somebody subscribes."""
        return bool(self._links)

    @property
    def dropped(self) -> int:
        with self._lock:
            return self._dropped_before + sum(link.dropped for link in self._links)

    @property
    def subscribers(self) -> list[str]:
        """Their names."""
        with self._lock:
            return [link.name for link in self._links]

    def publish(self, body: bytes) -> None:
        """To all who subscribe; waits for nobody."""
        self.next_sequence = self.next_sequence + 1 & 0xFFFFFFFF
        message = len(body).to_bytes(4, "little") + body
        with self._lock:
            for link in self._links:
                link.put(message)

    def connect(self, connection: socket.socket, fields: dict[str, str]) -> None:
        """Serve a subscriber that has said what it wants.

        Raises RosError, OSError: the connection is the caller's then.
        """
        for key, ours in (("type", self.kind.name), ("md5sum", self.kind.md5)):
            if fields.get(key) not in (ANY, ours):
                raise RosError(f"{self.topic} has {key} {ours}, not {str(fields.get(key))[:80]}")
        with self._lock:
            if len(self._links) >= MOST_SUBSCRIBERS:
                raise RosError(f"{self.topic} has {MOST_SUBSCRIBERS} subscribers: no more are served")
            connection.sendall(encode_fields(self._fields))
            link = _Link(connection, fields.get("callerid", ""), self._queue_size)
            self._links.append(link)
        threading.Thread(target=self._serve, args=(link,), name="voltcam-ros1-topic", daemon=True).start()

    def close(self) -> None:
        """Let all subscribers go."""
        with self._lock:
            for link in self._links:
                link.close()

    def _serve(self, link: "_Link") -> None:
        try:
            link.run()
        finally:
            link.close()
            with self._lock:
                self._links.remove(link)
                self._dropped_before += link.dropped


class _Link:
    """One subscriber."""

    def __init__(self, connection: socket.socket, name: str, queue_size: int) -> None:
        self.name, self.dropped = name, 0
        self._connection = connection
        self._queue: deque[bytes] = deque(maxlen=queue_size)
        self._closed = False
        self._changed = threading.Condition()

    def put(self, message: bytes) -> None:
        with self._changed:
            self.dropped += len(self._queue) == self._queue.maxlen
            self._queue.append(message)
            self._changed.notify()

    def run(self) -> None:
        """Until it has left, or `close`."""
        while True:
            with self._changed:
                while not self._queue and not self._closed:
                    self._changed.wait()
                if self._closed:
                    return
                message = self._queue.popleft()
            try:
                self._connection.sendall(message)
            except OSError:
                return

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify()
        with contextlib.suppress(OSError):  # it has left
            self._connection.shutdown(socket.SHUT_RDWR)
        self._connection.close()
