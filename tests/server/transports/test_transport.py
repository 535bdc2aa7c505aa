"""What all transports share: an outbox that never holds up who publishes, and an end."""

import threading

import pytest

from voltcam_client.packet import TOPIC_EVENTS
from voltcam_server.messages import Message
from voltcam_server.transports import Transport, TransportStatus
from voltcam_server.transports import transport as transport_module

from ..rig import PATIENCE_S, until


class Slow(Transport):
    """Sends when it is let, and keeps what it sent and dropped."""

    name = "slow"

    def __init__(self, breaks_at: str = "") -> None:
        super().__init__()
        self.go, self.sending = threading.Event(), threading.Event()
        self.sent: list[str] = []
        self.dropped: list[str] = []
        self.closed, self.breaks_at = 0, breaks_at

    @property
    def status(self) -> TransportStatus:
        return TransportStatus(address="here", packets_sent=len(self.sent), packets_dropped=len(self.dropped))

    def _send(self, message: Message) -> None:
        self.sending.set()
        assert self.go.wait(PATIENCE_S)
        name = message.parts("")[0].decode()
        if name == self.breaks_at:
            raise RuntimeError("a bug")
        self.sent.append(name)

    def _dropped(self, message: Message) -> None:
        self.dropped.append(message.parts("")[0].decode())

    def _close(self) -> None:
        self.closed += 1


def message(name: str, size: int = 10) -> Message:
    return Message(TOPIC_EVENTS, size, lambda _: (name.encode(),))


def test_messages_are_sent_in_order() -> None:
    transport = Slow()
    transport.go.set()
    for name in "ab":
        transport.publish(message(name))  # before it starts, too
    transport.start()
    for name in "cd":
        transport.publish(message(name))
    until(lambda: len(transport.sent) == 4, "all are sent")
    transport.stop()
    assert (transport.sent, transport.dropped, transport.closed) == (list("abcd"), [], 1)


def test_what_does_not_fit_pushes_out_the_oldest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 30 bytes: a is being sent and no longer counts."""
    monkeypatch.setattr(transport_module, "OUTBOX_BYTES", 30)
    transport = Slow()
    transport.start()
    transport.publish(message("a"))
    assert transport.sending.wait(PATIENCE_S)
    for name in "bcde":
        transport.publish(message(name))
    assert transport.dropped == ["b"]
    transport.publish(message("f", 25))
    assert transport.dropped == list("bcde")
    transport.go.set()
    until(lambda: len(transport.sent) == 2, "the rest is sent")
    transport.stop()
    assert transport.sent == ["a", "f"]


def test_one_that_is_larger_than_the_outbox_is_sent_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transport_module, "OUTBOX_BYTES", 30)
    transport = Slow()
    for name in "ab":
        transport.publish(message(name, 100))
    assert transport.dropped == ["a"]
    transport.go.set()
    transport.start()
    until(lambda: transport.sent == ["b"], "it is sent")
    transport.publish(message("c", 30))  # the outbox is empty, and counts as such
    until(lambda: transport.sent == ["b", "c"], "it is sent, too")
    transport.stop()
    assert transport.dropped == ["a"]


def test_an_error_of_ours_is_kept_and_ends_its_thread_and_nobody_else_s() -> None:
    transport = Slow(breaks_at="b")
    transport.go.set()
    transport.start()
    for name in "abc":
        transport.publish(message(name))
    until(lambda: transport.failure is not None, "it has failed")
    assert str(transport.failure) == "a bug"
    transport.publish(message("d"))
    transport.stop()
    assert (transport.sent, transport.closed) == (["a"], 1)


def test_one_that_never_started_is_closed() -> None:
    transport = Slow()
    transport.publish(message("a"))
    transport.stop()
    assert (transport.sent, transport.closed) == ([], 1)


def test_what_a_thread_still_uses_is_not_taken_from_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transport_module, "END_S", 0.01)
    transport = Slow()
    transport.start()
    transport.publish(message("a"))
    assert transport.sending.wait(PATIENCE_S)
    transport.stop()
    assert transport.closed == 0
    transport.go.set()
    until(lambda: transport.sent == ["a"], "it ends by itself")
    transport.stop()
    assert transport.closed == 1
