"""DV, read by hand: what a port gives, and what a slow, a rude or one reader too many costs."""

import contextlib
import socket
from collections.abc import Iterator

import numpy as np
import pytest

from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import read_events, read_frame
from voltcam_client.dv.streams import DvStream, header_bytes, read_header
from voltcam_client.packet import TOPIC_EVENTS, FrameMessage
from voltcam_server.messages import (
    Message,
    events_message,
    frame_message,
    status_message,
)
from voltcam_server.problems import UsageError
from voltcam_server.transports import DvTransport
from voltcam_server.transports.dv import MOST_READERS
from voltcam_server.transports.dv_reader import READER_BYTES

from ..rig import PATIENCE_S, until
from .dv_rig import HEIGHT, WIDTH, packet, port_of, started


@pytest.fixture
def transport() -> Iterator[DvTransport]:
    yield from started()


@contextlib.contextmanager
def _connected(transport: DvTransport, stream: int = 0) -> Iterator[socket.socket]:
    """A reader by hand, taken in, its header read."""
    with socket.create_connection(("127.0.0.1", port_of(transport) + stream), PATIENCE_S) as connection:
        address = "{}:{}".format(*connection.getsockname())
        until(
            lambda: address in {client.address for client in transport.status.clients},
            "the reader is let in",
        )
        yield connection


def _take(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        more = connection.recv(size - len(data))
        assert more, "the connection has ended"
        data += more
    return data


def _header(connection: socket.socket) -> bytes:
    head = _take(connection, 4)
    return head + _take(connection, int.from_bytes(head, "little"))


def _packet(connection: socket.socket) -> bytes:
    stream, size = PACKET.unpack(_take(connection, PACKET.size))
    assert stream == 0
    return _take(connection, size)


def test_each_stream_begins_with_its_header(transport: DvTransport) -> None:
    for number, kind in enumerate(("EVTS", "FRME")):
        stream = DvStream(0, kind, "DAVIS346_EMU00001", (WIDTH, HEIGHT))
        with _connected(transport, number) as reader:
            header = _header(reader)
        assert header == header_bytes([stream])
        assert read_header(header).streams == (stream,)


def test_a_port_has_its_stream_only(transport: DvTransport) -> None:
    image = np.full((HEIGHT, WIDTH), 7, np.uint8)
    with _connected(transport, 0) as events, _connected(transport, 1) as frames:
        transport.publish(status_message({}))
        transport.publish(frame_message(FrameMessage(image=image, seq=0, t_us=3, stamp_ns=1)))
        transport.publish(events_message(packet(1)))
        _header(events), _header(frames)
        np.testing.assert_array_equal(read_events(_packet(events)), packet(1).events)
        np.testing.assert_array_equal(read_frame(_packet(frames)).image, image)
        topics = {client.topic for client in transport.status.clients}
    assert topics == {"events", "frames"}


def test_a_packet_without_events_is_left_out(transport: DvTransport) -> None:
    with _connected(transport) as reader:
        _header(reader)
        for count in (0, 3, 0, 5):
            transport.publish(events_message(packet(1, count)))
        assert [read_events(_packet(reader)).size for _ in range(2)] == [3, 5]


def test_a_sensor_that_the_records_cannot_hold_is_refused() -> None:
    with pytest.raises(UsageError, match="DV holds 32768 pixels a side, not 40000 x 8: give --dv off"):
        DvTransport("127.0.0.1:0", 40_000, 8, "EMU00001")


def test_a_reader_that_stalls_costs_only_itself(transport: DvTransport) -> None:
    """It misses whole packets, the oldest, and what waits for it is bounded; another gets all."""
    count, size = 300, 16_384  # 79 MB
    with _connected(transport) as stalled, _connected(transport) as quick:
        _header(quick)
        slow, fast = (transport.status.clients[i].address for i in (0, 1))
        for seq in range(count):
            transport.publish(events_message(packet(seq, size)))
            assert read_events(_packet(quick))["t"][0] == 1000 * seq
        by_address = {client.address: client for client in transport.status.clients}
        assert by_address[fast].sent == count
        assert by_address[fast].dropped == 0
        dropped = by_address[slow].dropped
        assert dropped > 0
        assert transport.status.packets_dropped == dropped
        _header(stalled)
        seqs = [int(read_events(_packet(stalled))["t"][0]) // 1000 for _ in range(count - dropped)]
    assert seqs == sorted(set(seqs))
    assert seqs[-1] == count - 1
    assert (seqs[-1] - seqs[0]) * size * 16 >= READER_BYTES


def test_a_reader_that_has_left_is_forgotten(transport: DvTransport) -> None:
    with _connected(transport) as reader:
        _header(reader)
        transport.publish(events_message(packet(0)))
        _packet(reader)
    until(lambda: not transport.status.clients, "it is forgotten")
    assert transport.status.packets_sent == 1


def test_who_speaks_is_no_reader(transport: DvTransport) -> None:
    with _connected(transport) as rude, _connected(transport) as reader:
        rude.sendall(b"GET / HTTP/1.1\r\n\r\n")
        until(lambda: len(transport.status.clients) == 1, "it is let go")
        transport.publish(events_message(packet(0)))
        _header(reader)
        assert read_events(_packet(reader)).size == 2


def test_one_reader_too_many_is_not_let_in(transport: DvTransport, caplog: pytest.LogCaptureFixture) -> None:
    with contextlib.ExitStack() as stack:
        for _ in range(MOST_READERS):
            stack.enter_context(_connected(transport))
        with socket.create_connection(("127.0.0.1", port_of(transport)), PATIENCE_S) as late:
            assert late.recv(1) == b""
        assert len(transport.status.clients) == MOST_READERS
    until(lambda: "32 readers are here already" in caplog.text, "it is said")
    until(lambda: not transport.status.clients, "all are forgotten")
    with _connected(transport) as reader:
        _header(reader)


def test_what_nobody_reads_is_not_encoded(transport: DvTransport) -> None:
    with _connected(transport, 1) as frames:
        transport.publish(Message(TOPIC_EVENTS, 10, lambda _: (), content="no packet at all"))
        transport.publish(
            frame_message(FrameMessage(image=np.zeros((2, 2), np.uint8), seq=0, t_us=3, stamp_ns=1))
        )
        _header(frames)
        assert read_frame(_packet(frames)).t_us == 3
    assert transport.failure is None


def test_ports_that_are_taken_are_named(transport: DvTransport) -> None:
    for taken in (port_of(transport), port_of(transport) + 1):
        with pytest.raises(
            UsageError, match=f":{taken}: Address already in use: .* another with --dv"
        ) as error:
            DvTransport(f"127.0.0.1:{taken}", WIDTH, HEIGHT, "EMU00001")
        assert "\n" not in str(error.value)


def test_it_gives_its_ports_back() -> None:
    first = DvTransport("127.0.0.1:0", WIDTH, HEIGHT, "EMU00001")
    first.stop()  # without a start
    again = DvTransport(first.address, WIDTH, HEIGHT, "EMU00001")
    again.start()
    again.stop()
    DvTransport(first.address, WIDTH, HEIGHT, "EMU00001").stop()
