"""UDP datagrams, as faery reads them; AEStream's reader is in `tests/interop`."""

import socket
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from voltcam_client.encodings import EVENT, Events
from voltcam_client.packet import FrameMessage, Packet
from voltcam_server.messages import events_message, frame_message
from voltcam_server.problems import UsageError
from voltcam_server.transports import UdpTransport

WAIT_S = 30
# faery's reader in a process of its own: it says when it listens, then each event, until a row of nines.
FAERY = """
import sys, faery, numpy as np
stream = iter(faery.events_stream_from_udp((640, 480), ("127.0.0.1", int(sys.argv[1])), "t32_x16_y15_on1"))
print("listening", flush=True)
for events in stream:
    for event in events:
        print(event["t"], event["x"], event["y"], int(event["on"]))
    if (events["x"] == 639).any():
        break
"""


def drawn(count: int, start_us: int) -> Events:
    rng = np.random.default_rng(1)
    events = np.zeros(count, EVENT)
    events["t"] = start_us + np.sort(rng.integers(0, 1_000_000, count))
    events["x"], events["y"], events["p"] = (rng.integers(0, n, count) for n in (639, 480, 2))
    events["x"][-1] = 639
    return events


def packet_of(events: Events) -> Packet:
    base_us = int(events["t"][0])
    return Packet(events=events, width=640, height=480, seq=0, time_base_ns=1000 * base_us, stamp_ns=1)


@pytest.fixture
def receiver() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        one.settimeout(WAIT_S)
        yield one


def test_faery_reads_the_events(receiver: socket.socket) -> None:
    port = receiver.getsockname()[1]
    receiver.close()
    events = drawn(3000, 4_000_000_000)
    with subprocess.Popen(
        [sys.executable, "-c", FAERY, str(port)], stdout=subprocess.PIPE, text=True
    ) as reader:
        assert reader.stdout is not None
        transport = UdpTransport(f"127.0.0.1:{port}", "t32_x16_y15_on1", 640, 480)
        transport.start()
        try:
            while not _bound(port):
                assert reader.poll() is None
            assert reader.stdout.readline() == "listening\n"
            transport.publish(events_message(packet_of(events)))
            rows = [tuple(map(int, line.split())) for line in reader.stdout]
            assert reader.wait(WAIT_S) == 0
        finally:
            reader.kill()
            transport.stop()
    assert rows == [(int(e["t"]), int(e["x"]), int(e["y"]), int(e["p"])) for e in events]
    assert transport.status.packets_sent == 1


def _bound(port: int) -> bool:
    """faery binds when its first event is asked for, in a thread."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        try:
            one.bind(("127.0.0.1", port))
        except OSError:
            return True
        return False


def test_frames_are_left_out_and_events_counted(receiver: socket.socket) -> None:
    transport = UdpTransport(f"127.0.0.1:{receiver.getsockname()[1]}", "spif", 640, 480)
    transport.start()
    try:
        image = np.zeros((480, 640), np.uint8)
        transport.publish(frame_message(FrameMessage(image=image, seq=0, t_us=0, stamp_ns=0)))
        events = drawn(300, 0)
        transport.publish(events_message(packet_of(events)))
        words = np.concatenate([np.frombuffer(receiver.recv(4096), "<u4") for _ in range(3)])
    finally:
        transport.stop()
    np.testing.assert_array_equal(words >> 16 & 0x7FFF, events["x"])
    np.testing.assert_array_equal(words & 0x7FFF, events["y"])
    np.testing.assert_array_equal(words >> 15 & 1, events["p"])
    assert (words >> 31 == 1).all()
    assert (transport.status.packets_sent, transport.status.packets_dropped) == (1, 0)


@pytest.mark.parametrize(
    ("address", "size", "said"),
    [
        ("127.0.0.1:70000", (8, 8), "ports go from 1 to 65535"),
        ("127.0.0.1:0", (8, 8), "ports go from 1 to 65535"),
        ("no.such.host.invalid:3333", (8, 8), "give HOST:PORT"),
        ("127.0.0.1:3333", (40_000, 8), "holds 32768 pixels a side"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(address: str, size: tuple[int, int], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        UdpTransport(address, "spif", *size)
