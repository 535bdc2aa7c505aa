"""What waits for a reader, by packets that a connection takes or does not."""

import socket
from collections.abc import Iterator

import pytest

from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_server.transports import dv_reader
from voltcam_server.transports.dv_reader import DvReader

from ..rig import PATIENCE_S

HEADER = b"header"
MOST = 1000


@pytest.fixture
def connection(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[socket.socket, socket.socket]]:
    """The daemon's end and the reader's."""
    monkeypatch.setattr(dv_reader, "READER_BYTES", MOST)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        theirs = socket.create_connection(listener.getsockname(), PATIENCE_S)
        ours, _ = listener.accept()
    with ours, theirs:
        yield ours, theirs


def packet(number: int, size: int = 300) -> bytearray:
    return bytearray([number]) * size


def test_the_header_comes_first_and_packets_in_order(
    connection: tuple[socket.socket, socket.socket],
) -> None:
    ours, theirs = connection
    reader = DvReader(ours, TOPIC_EVENTS, HEADER)
    for number in range(3):
        reader.offer(packet(number))
    assert reader.flush()
    expected = HEADER + b"".join(packet(number) for number in range(3))
    assert theirs.recv(len(expected), socket.MSG_WAITALL) == expected
    assert (reader.sent, reader.dropped) == (3, 0)


def test_what_has_left_does_not_count_as_waiting(connection: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = connection
    reader = DvReader(ours, TOPIC_EVENTS, b"")
    for number in range(20):  # six times what may wait, never more than two packets at a time
        reader.offer(packet(number))
        reader.offer(packet(number))
        assert reader.flush()
        assert len(theirs.recv(600, socket.MSG_WAITALL)) == 600
    assert (reader.sent, reader.dropped) == (40, 0)


def test_the_oldest_that_wait_are_dropped_and_never_a_part(
    connection: tuple[socket.socket, socket.socket],
) -> None:
    ours, theirs = connection
    large = bytes(20_000_000)
    reader = DvReader(ours, TOPIC_EVENTS, large)
    assert not reader.flush()  # the connection is full
    for number in range(10):
        reader.offer(packet(number))
    assert (reader.sent, reader.dropped) == (0, 7)
    data = b""
    expected = large + b"".join(packet(number) for number in (7, 8, 9))
    while len(data) < len(expected):
        reader.flush()
        data += theirs.recv(1 << 20)
    assert data == expected


def test_a_packet_that_is_larger_than_all_that_may_wait_is_kept(
    connection: tuple[socket.socket, socket.socket],
) -> None:
    reader = DvReader(connection[0], TOPIC_EVENTS, bytes(20_000_000))
    reader.flush()
    reader.offer(packet(1))
    reader.offer(packet(2, 5000))
    assert (reader.dropped, reader.status.dropped) == (1, 1)


def test_who_has_left_or_speaks(connection: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = connection
    reader = DvReader(ours, TOPIC_FRAMES, HEADER)
    assert not reader.has_left()
    theirs.sendall(b"x")
    assert reader.has_left()
    theirs.close()
    assert reader.has_left()
    assert (reader.status.topic, reader.status.encoding) == ("frames", None)
