"""UDP: faery is the reader of its form; the words of AEStream are read by their published bits."""

import importlib.util
import logging
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Self

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_client.packet import EVENT, FrameMessage, Packet
from voltcam_server.messages import Message, events_message, frame_message, status_message
from voltcam_server.problems import UsageError
from voltcam_server.transports import UdpTransport
from voltcam_server.transports.udp import DATAGRAM_EVENTS

from ..process import Daemon
from ..rig import PATIENCE_S, until

WIDTH, HEIGHT = 346, 260
WRAP_US = 2**32


def random_events(
    count: int, start_us: int = 0, width: int = WIDTH, height: int = HEIGHT
) -> NDArray[np.void]:
    rng = np.random.default_rng(count)
    events = np.empty(count, EVENT)
    events["t"] = start_us + np.cumsum(rng.integers(0, 50, count))
    events["x"], events["y"] = rng.integers(0, width, count), rng.integers(0, height, count)
    events["p"] = rng.integers(0, 2, count)
    events["x"][-1], events["y"][-1] = width - 1, height - 1
    return events


def message(events: NDArray[np.void], width: int = WIDTH, height: int = HEIGHT) -> Message:
    return events_message(
        Packet(events=events, width=width, height=height, seq=0, time_base_ns=0, stamp_ns=1)
    )


@pytest.fixture
def receiver() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(PATIENCE_S)
        yield receiver


def _sent(receiver: socket.socket, form: str, *messages: Message, size: tuple[int, int]) -> UdpTransport:
    transport = UdpTransport(f"{form}://127.0.0.1:{receiver.getsockname()[1]}", *size)
    transport.start()
    for each in messages:
        transport.publish(each)
    until(lambda: transport.status.packets_sent + transport.status.packets_dropped, "they are sent")
    return transport


def _datagrams(receiver: socket.socket, events: int, event_bytes: int) -> list[bytes]:
    datagrams: list[bytes] = []
    while sum(map(len, datagrams)) < events * event_bytes:
        datagrams.append(receiver.recv(65536))
    return datagrams


@pytest.mark.parametrize("size", [(WIDTH, HEIGHT), (32768, 32768)])
def test_spif_words_have_all_but_the_time(receiver: socket.socket, size: tuple[int, int]) -> None:
    events = random_events(1000, width=size[0], height=size[1])
    transport = _sent(receiver, "spif", message(events, *size), size=size)
    datagrams = _datagrams(receiver, 1000, 4)
    transport.stop()
    assert [len(datagram) for datagram in datagrams] == 7 * [4 * DATAGRAM_EVENTS] + [4 * 104]
    halves = np.frombuffer(b"".join(datagrams), "<u2").reshape(-1, 2)
    np.testing.assert_array_equal(halves[:, 0] & 0x7FFF, events["y"])
    np.testing.assert_array_equal(halves[:, 0] >> 15, events["p"])
    np.testing.assert_array_equal(halves[:, 1] & 0x7FFF, events["x"])
    assert set(halves[:, 1] >> 15) == {1}


class Reading:
    """A process of a library's UDP input; it listens when made, and is a context manager that ends it."""

    def __init__(self, library: str, count: int, size: tuple[int, int], file: Path) -> None:
        if importlib.util.find_spec(library) is None:
            pytest.skip(f"{library}, the oracle, is not installed")
        self.port, self.file = _free_port(), file
        program = str(Path(__file__).with_name(f"{library}_reader.py"))
        arguments = map(str, (self.port, count, *size, file))
        self.process = subprocess.Popen([sys.executable, program, *arguments])
        until(lambda: _is_bound(self.port), "it listens")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()

    def result(self) -> NDArray[np.void]:
        self.process.wait(2 * PATIENCE_S)
        events: NDArray[np.void] = np.load(self.file)
        return events


def _is_bound(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return True
    return False


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.mark.parametrize(
    ("size", "start_us"),
    [((WIDTH, HEIGHT), 0), ((65536, 32768), 0), ((WIDTH, HEIGHT), WRAP_US - 20_000)],
    ids=["a DAVIS346", "the largest camera", "over a wrap"],
)
def test_faery_reads_every_event(
    size: tuple[int, int], start_us: int, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    events = random_events(4000, start_us, *size)
    with Reading("faery", events.size, size, tmp_path / "events.npy") as reading:
        transport = UdpTransport(f"t32_x16_y15_on1://127.0.0.1:{reading.port}", *size)
        transport.start()
        for first in range(0, events.size, 1000):
            transport.publish(message(events[first : first + 1000], *size))
        result = reading.result()
        transport.stop()
    for own, theirs in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        np.testing.assert_array_equal(result[theirs], events[own])
    assert transport.status.packets_sent == 4
    assert ("2^32" in caplog.text) == (start_us > 0)


def test_aestream_reads_every_event(tmp_path: Path) -> None:
    """It keeps how many there were at each pixel."""
    events = random_events(4000)
    expected = np.zeros((WIDTH, HEIGHT))
    np.add.at(expected, (events["x"], events["y"]), 1)
    with Reading("aestream", events.size, (WIDTH, HEIGHT), tmp_path / "events.npy") as reading:
        transport = UdpTransport(f"spif://127.0.0.1:{reading.port}", WIDTH, HEIGHT)
        transport.start()
        for first in range(0, events.size, 1000):
            transport.publish(message(events[first : first + 1000]))
        result = reading.result()
        transport.stop()
    np.testing.assert_array_equal(result, expected)


def test_the_bytes_of_the_page_are_those_that_are_sent(receiver: socket.socket) -> None:
    page = Path(__file__).parents[3] / "docs" / "reference" / "packets.md"
    hexes = re.findall(r'fromhex\("([0-9a-f ]+)"\)', page.read_text())
    events = np.array([(1000, 3, 2, 1), (WRAP_US + 5, 345, 259, 0)], EVENT)
    for form, count in (("spif", 1), ("t32_x16_y15_on1", 2)):
        transport = _sent(receiver, form, message(events), size=(WIDTH, HEIGHT))
        sent = [receiver.recv(65536) for _ in range(count)]
        transport.stop()
        assert sent == [bytes.fromhex(hexes.pop(0)) for _ in range(count)]


def test_each_wrap_is_told_once(caplog: pytest.LogCaptureFixture, receiver: socket.socket) -> None:
    messages = [message(random_events(10, WRAP_US * i)) for i in (0, 1, 1, 2)]
    transport = _sent(receiver, "t32_x16_y15_on1", *messages, size=(WIDTH, HEIGHT))
    until(lambda: transport.status.packets_sent == 4, "all are sent")
    transport.stop()
    assert [record.message.count("2^32 us") for record in caplog.records] == [1, 1]


def test_that_spif_has_no_times_is_told_at_the_start(caplog: pytest.LogCaptureFixture) -> None:
    UdpTransport("spif://127.0.0.1:9", WIDTH, HEIGHT).stop()
    assert [record.levelno for record in caplog.records] == [logging.WARNING]
    assert "no times" in caplog.text


def test_what_is_no_event_is_not_sent(receiver: socket.socket) -> None:
    image = np.zeros((HEIGHT, WIDTH), np.uint8)
    frame = frame_message(FrameMessage(image=image, seq=0, t_us=3, stamp_ns=1))
    empty = message(np.empty(0, EVENT))
    one = message(random_events(1))
    transport = _sent(receiver, "spif", frame, status_message({}), empty, one, size=(WIDTH, HEIGHT))
    assert len(receiver.recv(65536)) == 4
    transport.stop()
    assert transport.status.packets_sent == 1


@pytest.mark.parametrize(
    ("form", "size"),
    [
        ("spif", (32769, 8)),
        ("spif", (8, 32769)),
        ("t32_x16_y15_on1", (65537, 8)),
        ("t32_x16_y15_on1", (8, 32769)),
    ],
)
def test_a_camera_too_large_for_the_form_is_refused(form: str, size: tuple[int, int]) -> None:
    with pytest.raises(UsageError, match=f"--udp {form} holds .* not {size[0]} x {size[1]}: give --udp off"):
        UdpTransport(f"{form}://127.0.0.1:9", *size)


def test_a_host_that_is_none_is_named() -> None:
    with pytest.raises(UsageError, match=r"nowhere\.invalid:9: .*: give --udp FORM://HOST:PORT"):
        UdpTransport("spif://nowhere.invalid:9", WIDTH, HEIGHT)


def test_what_the_network_does_not_take_is_counted() -> None:
    transport = UdpTransport("spif://255.255.255.255:9", WIDTH, HEIGHT)  # a broadcast, which is not allowed
    transport.start()
    transport.publish(message(random_events(10)))
    until(lambda: transport.status.packets_dropped == 1, "it is counted")
    transport.stop()
    assert transport.failure is None


def test_a_daemon_sends_to_faery(tmp_path: Path) -> None:
    with Reading("faery", 5000, (WIDTH, HEIGHT), tmp_path / "events.npy") as reading:
        url = f"t32_x16_y15_on1://127.0.0.1:{reading.port}"
        with Daemon("--dv", "off", "--udp", url) as daemon:
            assert f"UDP       {url}  (events are sent there" in daemon.banner
            result = reading.result()
            status = daemon.get("status")["transports"]["udp"]
    assert result.size >= 5000
    assert (np.diff(result["t"].astype(np.int64)) >= 0).all()
    assert status["packets_sent"] > 0
    assert status["address"] == url
