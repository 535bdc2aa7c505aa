"""What all transports share: a thread of their own behind a bounded outbox, and counters."""

import threading
from abc import ABC, abstractmethod
from collections import deque
from typing import ClassVar

from pydantic import BaseModel, ConfigDict

from ..messages import Message

OUTBOX_BYTES = 32 * 2**20
END_S = 1.0


class ClientStatus(BaseModel):
    """One subscriber that the transport knows by itself."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    address: str
    """HOST:PORT"""

    topic: str
    """events, frames, imu or triggers"""

    encoding: str | None
    """of its event packets; null for all else"""

    sent: int
    """messages"""

    dropped: int
    """messages that it was too slow for"""


class TransportStatus(BaseModel):
    """Event packets of a transport, summed over its clients where it knows them."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    address: str
    """where it is reached"""

    packets_sent: int
    """since the start"""

    packets_dropped: int
    """since the start"""

    clients: list[ClientStatus] = []
    """those that it knows by itself"""


class Transport(ABC):
    """Sends what is published, in order; when it cannot keep up, the oldest that waits is dropped.

    `publish` never waits and never raises, so that a transport costs nobody but its own subscribers.
    failure: an error of ours that has ended its thread.
    """

    name: ClassVar[str]

    def __init__(self) -> None:
        self.failure: Exception | None = None
        self._outbox: deque[Message] = deque()
        self._outbox_bytes = 0
        self._changed = threading.Condition()
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name=f"voltcam-{self.name}", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def publish(self, message: Message) -> None:
        if not self._has_audience:  # a thread that wakes a thousand times a second slows all others
            return
        with self._changed:
            self._outbox.append(message)
            self._outbox_bytes += message.size
            while self._outbox_bytes > OUTBOX_BYTES and len(self._outbox) > 1:
                oldest = self._outbox.popleft()
                self._outbox_bytes -= oldest.size
                self._dropped(oldest)
            self._tell()

    def stop(self) -> None:
        """End the thread and give back what it held; what waits is not sent."""
        with self._changed:
            self._stopping = True
            self._tell()
        if self._thread.ident is not None:
            self._thread.join(END_S)
        if not self._thread.is_alive():  # what a thread still uses must not be taken from it
            self._close()

    @abstractmethod
    def _close(self) -> None:
        """Give back what is held; called once, after the thread has ended."""

    @property
    @abstractmethod
    def status(self) -> TransportStatus:
        """Counters and clients."""

    @abstractmethod
    def _send(self, message: Message) -> None:
        """Hand one message on, without waiting for anyone."""

    @abstractmethod
    def _dropped(self, message: Message) -> None:
        """Count a message that did not leave the outbox."""

    @property
    def _has_audience(self) -> bool:
        """False where it is known that nobody would have a message: then its thread sleeps on."""
        return True

    def _tell(self) -> None:
        """Have the thread look: there is a message, or the end."""
        self._changed.notify_all()

    def _run(self) -> None:
        try:
            while (message := self._next()) is not None:
                self._send(message)
        except Exception as error:
            self.failure = error

    def _next(self) -> Message | None:
        with self._changed:
            while not self._outbox and not self._stopping:
                self._changed.wait()
            return self._take()

    def _take(self) -> Message | None:
        """The next message, where there is one and it is not the end."""
        with self._changed:
            if self._stopping or not self._outbox:
                return None
            message = self._outbox.popleft()
            self._outbox_bytes -= message.size
            return message
