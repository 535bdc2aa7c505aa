"""A reader of a DV stream: its connection, and the packets that wait for it."""

import socket
from collections import deque

from voltcam_client.packet import TOPIC_EVENTS

from .transport import ClientStatus

READER_BYTES = 16 * 2**20  # a DV event has twice the bytes of one of ZeroMQ
# One that vanished gives its queue back after 15 s.
KEEPALIVE = {socket.TCP_KEEPIDLE: 5, socket.TCP_KEEPINTVL: 5, socket.TCP_KEEPCNT: 2}


class DvReader:
    """Of one thread, but for `status`. Raises OSError for a connection that has ended already."""

    def __init__(self, connection: socket.socket, topic: bytes, header: bytes) -> None:
        self.socket, self.topic = connection, topic
        self.address = "{}:{}".format(*connection.getpeername()[:2])
        self.sent = self.dropped = 0
        self._queue: deque[bytearray] = deque()
        self._bytes = 0
        self._leaving = memoryview(header)  # what is being sent: it is never dropped
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, value in KEEPALIVE.items():
            connection.setsockopt(socket.IPPROTO_TCP, option, value)

    def offer(self, packet: bytearray) -> None:
        self._queue.append(packet)
        self._bytes += len(packet)
        while self._bytes > READER_BYTES and len(self._queue) > 1:
            self._bytes -= len(self._queue.popleft())
            self.dropped += 1

    def flush(self) -> bool:
        """Send what the connection takes; whether all has left. OSError as it comes."""
        while True:
            while self._leaving:
                try:
                    self._leaving = self._leaving[self.socket.send(self._leaving) :]
                except BlockingIOError:
                    return False
            if not self._queue:
                return True
            packet = self._queue.popleft()
            self._bytes -= len(packet)
            self._leaving = memoryview(packet)
            self.sent += 1

    def has_left(self) -> bool:
        """Whether the connection has ended, or has been spoken through."""
        try:
            self.socket.recv(1)
        except BlockingIOError:
            return False
        except OSError:
            pass
        return True

    @property
    def status(self) -> ClientStatus:
        return ClientStatus(
            address=self.address,
            topic=self.topic.decode(),
            encoding="dv" if self.topic == TOPIC_EVENTS else None,
            sent=self.sent,
            dropped=self.dropped,
        )
