"""DV: dv-processing's NetworkReader is the reader; and what a slow, a rude or one reader too many costs."""

import contextlib
import importlib.util
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import numpy as np
import pytest

from voltcam_client import EventCamera
from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import read_events, read_frame
from voltcam_client.dv.streams import DvStream, header_bytes, read_header
from voltcam_client.packet import EVENT, TOPIC_EVENTS, FrameMessage, Packet
from voltcam_client.samples import (
    IMU,
    TOPIC_IMU,
    TOPIC_TRIGGERS,
    TRIGGER,
    TRIGGER_KINDS,
    SamplesMessage,
)
from voltcam_server.messages import (
    Message,
    events_message,
    frame_message,
    samples_message,
    status_message,
)
from voltcam_server.problems import UsageError
from voltcam_server.transports import DvTransport
from voltcam_server.transports.dv import MOST_READERS
from voltcam_server.transports.dv_reader import READER_BYTES

from ..process import Daemon
from ..rig import PATIENCE_S, until
from .other_program import OtherProgram

WIDTH, HEIGHT = 346, 260


def packet(seq: int, count: int = 2) -> Packet:
    events = np.zeros(count, EVENT)
    events["t"], events["x"], events["p"] = 1000 * seq + np.arange(count), seq % WIDTH, seq % 2
    return Packet(events=events, width=WIDTH, height=HEIGHT, seq=seq, time_base_ns=0, stamp_ns=1)


@pytest.fixture
def transport() -> Iterator[DvTransport]:
    transport = DvTransport("127.0.0.1:0", WIDTH, HEIGHT, "EMU00001")
    transport.start()
    yield transport
    transport.stop()


def _port(transport: DvTransport) -> int:
    return int(transport.address.rpartition(":")[2])


@contextlib.contextmanager
def _connected(transport: DvTransport, stream: int = 0) -> Iterator[socket.socket]:
    """A reader by hand, taken in, its header read."""
    with socket.create_connection(("127.0.0.1", _port(transport) + stream), PATIENCE_S) as connection:
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


class Reading(OtherProgram):
    """A process of dv-processing's NetworkReader; connected when made. It says the camera's name."""

    def __init__(self, kind: str, port: int, count: int, file: Path) -> None:
        if importlib.util.find_spec("dv_processing") is None:
            pytest.skip("dv-processing, the oracle, is not installed")
        super().__init__("network_reader.py", kind, str(port), str(count), str(file), file=file)


def test_dv_processing_reads_every_event(transport: DvTransport, tmp_path: Path) -> None:
    packets = [packet(seq, 1 + 37 * seq % 5000) for seq in range(200)]
    expected = np.concatenate([each.events for each in packets])
    with Reading("events", _port(transport), expected.size, tmp_path / "events.npz") as reading:
        assert reading.said == "DAVIS346_EMU00001 of 346 x 260"
        until(lambda: bool(transport.status.clients), "the reader is let in")
        for each in packets:
            transport.publish(events_message(each))
        events = reading.result()["events"]
    assert events.size == expected.size
    for own, theirs in (("t", "timestamp"), ("x", "x"), ("y", "y"), ("p", "polarity")):
        np.testing.assert_array_equal(events[theirs], expected[own])
    until(lambda: transport.status.packets_sent == 200, "all are counted")


def test_dv_processing_reads_every_frame(transport: DvTransport, tmp_path: Path) -> None:
    images = np.random.default_rng(1).integers(0, 256, (3, HEIGHT, WIDTH), np.uint8)
    with Reading("frames", _port(transport) + 1, 3, tmp_path / "frames.npz") as reading:
        assert reading.said == "DAVIS346_EMU00001 of 346 x 260"
        until(lambda: bool(transport.status.clients), "the reader is let in")
        for seq, image in enumerate(images):
            transport.publish(frame_message(FrameMessage(image=image, seq=seq, t_us=7000 + seq, stamp_ns=1)))
        result = reading.result()
    np.testing.assert_array_equal(result["images"], images)
    assert result["t_us"].tolist() == [7000, 7001, 7002]


def test_dv_processing_reads_exposures(transport: DvTransport, tmp_path: Path) -> None:
    image = np.full((HEIGHT, WIDTH), 9, np.uint8)
    frame = FrameMessage(image=image, seq=0, t_us=7250, stamp_ns=1, exposure_us=(7000, 7500))
    with Reading("frames", _port(transport) + 1, 1, tmp_path / "frames.npz") as reading:
        until(lambda: bool(transport.status.clients), "the reader is let in")
        transport.publish(frame_message(frame))
        result = reading.result()
    assert (result["t_us"].tolist(), result["exposure_us"].tolist()) == ([7000], [500])


def test_dv_processing_reads_triggers_and_imu(transport: DvTransport, tmp_path: Path) -> None:
    triggers = np.array([(5, 1), (6, 2), (7, 8)], TRIGGER)
    samples = np.zeros(3, IMU)
    samples["t"], samples["temperature_c"], samples["gyro_deg_s"] = (5, 6, 7), 25.5, (1, 2, 3)
    streams = ((2, "triggers", TOPIC_TRIGGERS, triggers), (3, "imu", TOPIC_IMU, samples))
    for port, kind, topic, rows in streams:
        with Reading(kind, _port(transport) + port, 3, tmp_path / f"{kind}.npz") as reading:
            assert reading.said == "DAVIS346_EMU00001 of 0 x 0"
            until(lambda: bool(transport.status.clients), "the reader is let in")
            transport.publish(samples_message(topic, SamplesMessage(samples=rows, seq=0, stamp_ns=1)))
            (theirs,) = reading.result().values()
        assert theirs.tolist() == [np.hstack(row.tolist()).tolist() for row in rows]
        until(lambda: not transport.status.clients, "the reader is forgotten")


def test_dv_processing_gets_all_that_a_davis_gives(tmp_path: Path) -> None:
    """At their rates, on one clock, and the same over ZeroMQ."""
    arguments = ("--dv", "127.0.0.1:0", "--frames", "aps", "--imu", "500", "--triggers", "20")
    with Daemon(*arguments) as daemon, contextlib.ExitStack() as stack:
        port = int(str(daemon.get("camera")["dv"]).rpartition(":")[2])
        counts = {"frames": (1, 10), "triggers": (2, 60), "imu": (3, 300)}
        readings = [
            stack.enter_context(Reading(kind, port + offset, count, tmp_path / f"{kind}.npz"))
            for kind, (offset, count) in counts.items()
        ]
        camera = stack.enter_context(EventCamera(daemon.zmq, timeout_s=PATIENCE_S))
        sample = stack.enter_context(camera.imu()).receive(PATIENCE_S)
        trigger = stack.enter_context(camera.triggers()).receive(PATIENCE_S)
        frame = stack.enter_context(camera.frames()).receive(PATIENCE_S)
        frames, triggers, imu = (reading.result() for reading in readings)
    assert sample is not None
    assert trigger is not None
    assert frame is not None
    assert frame.exposure_us is not None
    assert set(np.diff(frames["t_us"]) % 40_000) == {0}  # what a busy machine skips has no frame
    assert set(frames["exposure_us"]) == {500}
    assert (frame.exposure_us[0] - frames["t_us"][0]) % 40_000 == 0
    times, kinds = triggers["triggers"].T
    assert set(np.diff(times[kinds == TRIGGER_KINDS["rising edge"]])) == {50_000}
    begins = times[kinds == TRIGGER_KINDS["exposure begins"]]
    assert set((begins - frames["t_us"][0]) % 40_000) == {0}
    assert set(np.diff(imu["samples"][:, 0])) == {2000}
    assert np.abs(imu["samples"][:, 1:5].mean(0) - (25, 0, -1, 0)).max() < 0.01
    assert (sample.samples["t"] % 2000 == 0).all()
    assert set(trigger.samples["kind"]) <= set(TRIGGER_KINDS.values())


def test_dv_processing_gets_the_events_that_our_own_client_gets(tmp_path: Path) -> None:
    with Daemon("--dv", "127.0.0.1:0") as daemon:
        port = int(str(daemon.get("camera")["dv"]).rpartition(":")[2])
        ours, done = [], threading.Event()

        def listen() -> None:
            with EventCamera(daemon.zmq, timeout_s=PATIENCE_S) as camera:
                for packet in camera:
                    ours.append(packet.events)
                    if done.is_set():
                        return

        listener = threading.Thread(target=listen)
        listener.start()
        until(lambda: len(ours) > 0, "our own client listens")
        with Reading("events", port, 30_000, tmp_path / "events.npz") as reading:
            theirs = reading.result()["events"]
        until(lambda: ours[-1].size > 0 and ours[-1]["t"][-1] > theirs["timestamp"][-1], "ours has all")
        done.set()
        listener.join(PATIENCE_S)
        transports = daemon.get("status")["transports"]
        metrics = httpx.get(daemon.url + "metrics", trust_env=False).text
    events = np.concatenate(ours)
    first, last = theirs["timestamp"][[0, -1]]
    events = events[(events["t"] > first) & (events["t"] < last)]
    theirs = theirs[(theirs["timestamp"] > first) & (theirs["timestamp"] < last)]
    assert events.size == theirs.size > 10_000
    for own, their_name in (("t", "timestamp"), ("x", "x"), ("y", "y"), ("p", "polarity")):
        np.testing.assert_array_equal(theirs[their_name], events[own])
    assert transports["dv"]["packets_sent"] > 0
    assert 'voltcam_packets_sent_total{camera="davis346",transport="dv"}' in metrics


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
        with socket.create_connection(("127.0.0.1", _port(transport)), PATIENCE_S) as late:
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
    for taken in (_port(transport), _port(transport) + 1):
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
