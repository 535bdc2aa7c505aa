"""`voltcam bench transports`: how many events a second a receiver in its own process has, and how late.

Each transport stands beside a plain TCP socket that carries as many bytes, measured in the same way at once
after it. At most AHEAD packets are under way, so that nothing is dropped and memory is bounded.
"""

import contextlib
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.errors import VoltcamError

from .bench_figure import REPEATS, Figure
from .bench_receivers import REPORT
from .bench_senders import HEIGHT, SENDERS, WIDTH, Kind, Sender, tcp

PACKET_EVENTS = 8192  # a daemon's largest packet
AHEAD = 40  # packets under way: 5 MB of DV, less than what makes a transport drop
LATENCY_EVENTS, LATENCY_PERIOD_S = 1000, 0.001  # a million events a second, in packets of 1 ms
LOOK_S = 1.5  # at each of throughput and latency
BEGIN_S, LOST_S = 15.0, 0.5
PAUSE_S, GREET_S = 0.0002, 0.02
REPORTED = np.dtype([("events", "<i8"), ("newest_us", "<i8"), ("at_ns", "<i8")])


class TransportSpeed(NamedTuple):
    """Of one transport: million events/s in each part of the look, and latencies of packets, ms."""

    rates: list[float]
    late_ms: NDArray[np.float64]


def transports(look_s: float = LOOK_S) -> Iterator[Callable[[], list[Figure]]]:
    """What is measured, in order."""
    for name, kind in SENDERS.items():
        yield partial(beside_tcp, name, kind, look_s)


def beside_tcp(name: str, kind: Kind, look_s: float) -> list[Figure]:
    """Throughput and latency, of a transport and of a socket with as many bytes; none without its library."""
    if not kind.there:
        return []
    full, small = (kind.wire_bytes(events_at(0, count)) for count in (PACKET_EVENTS, LATENCY_EVENTS))
    ours = TransportSpeed(rates(name, kind.open, 0, look_s), latencies(name, kind.open, 0, look_s))
    limit = TransportSpeed(
        rates("tcp", partial(tcp, full), full, look_s), latencies("tcp", partial(tcp, small), small, look_s)
    )
    share = np.median(ours.rates) / np.median(limit.rates)
    return [
        Figure.of(f"{name} throughput", ours.rates, "Mevents/s", f"{share:.2f} of the plain socket"),
        Figure.of(f"{name}: plain socket, same bytes", limit.rates, "Mevents/s", f"{full} bytes a packet"),
        *late(name, ours.late_ms),
        *late(f"{name}: plain socket", limit.late_ms),
    ]


def late(name: str, late_ms: NDArray[np.float64]) -> list[Figure]:
    """Median and 99th percentile of each of REPEATS parts."""
    parts = np.array_split(late_ms, REPEATS)
    return [
        Figure.of(f"{name} latency p{rank}", [float(np.percentile(part, rank)) for part in parts], "ms")
        for rank in (50, 99)
    ]


def rates(
    name: str, opened: Callable[[], AbstractContextManager[Sender]], packet_bytes: int, look_s: float
) -> list[float]:
    """Million events a second, in each of REPEATS parts of the packets that came."""
    events = events_at(0, PACKET_EVENTS)
    with _receiving(name, opened, packet_bytes) as (sender, reports):
        until_s, sent, begin = time.monotonic() + look_s, reports.events, reports.count
        while time.monotonic() < until_s:
            if sent - reports.events < AHEAD * PACKET_EVENTS:
                sender.send(events)
                sent += PACKET_EVENTS
                continue
            if time.time_ns() - reports.last_ns > LOST_S * 1e9:
                sent = reports.events  # the others are lost
            time.sleep(PAUSE_S)
        rows = reports.rows(begin)
    found = []
    for part in np.array_split(rows, REPEATS):
        span_ns = int(part["at_ns"][-1] - part["at_ns"][0])
        found.append(int(part["events"][1:].sum()) / max(span_ns, 1) * 1e3)
    return found


def latencies(
    name: str, opened: Callable[[], AbstractContextManager[Sender]], packet_bytes: int, look_s: float
) -> NDArray[np.float64]:
    """From just before a packet is published to when the receiver's program has it, ms."""
    with _receiving(name, opened, packet_bytes) as (sender, reports):
        begin, next_s = reports.count, time.monotonic()
        for _ in range(int(look_s / LATENCY_PERIOD_S)):
            sender.send(events_at(time.time_ns() // 1000, LATENCY_EVENTS))
            next_s += LATENCY_PERIOD_S
            time.sleep(max(0.0, next_s - time.monotonic()))
        time.sleep(GREET_S)  # for the last
        rows = reports.rows(begin)
    return np.asarray(rows["at_ns"] / 1e6 - rows["newest_us"] / 1e3)


def events_at(t_us: int, count: int) -> Events:
    """All over the sensor, all of one time."""
    events = np.zeros(count, EVENT)
    events["x"], events["y"], events["t"] = np.arange(count) % WIDTH, np.arange(count) % HEIGHT, t_us
    return events


class Reports:
    """What a receiver says of the packets that it has, gathered by a thread."""

    def __init__(self, process: "subprocess.Popen[bytes]") -> None:
        self.count = self.events = 0
        self.last_ns = time.time_ns()
        self._process, self._data = process, bytearray()
        self._thread = threading.Thread(target=self._gather, daemon=True)
        self._thread.start()

    def rows(self, begin: int) -> NDArray[np.void]:
        """From the packet `begin` on. Raises VoltcamError where too few came for a figure."""
        rows = np.frombuffer(bytes(self._data[: self.count * REPORT.size]), REPORTED)[begin:]
        if rows.size < 2 * REPEATS:
            raise VoltcamError(f"only {rows.size} packets came: is the machine too busy for a measurement?")
        return rows

    def _gather(self) -> None:
        assert self._process.stdout is not None
        while data := self._process.stdout.read1(1 << 16):  # type: ignore[attr-defined]
            self._data += data
            count = len(self._data) // REPORT.size
            new = bytes(self._data[self.count * REPORT.size : count * REPORT.size])
            self.events += int(np.frombuffer(new, REPORTED)["events"].sum())
            self.last_ns, self.count = time.time_ns(), count

    def end(self) -> None:
        self._process.kill()
        self._thread.join()


@contextlib.contextmanager
def _receiving(
    name: str, opened: Callable[[], AbstractContextManager[Sender]], packet_bytes: int
) -> Iterator[tuple[Sender, Reports]]:
    """A sender, and the reports of a receiver in its own process that has begun to receive."""
    command = [sys.executable, "-m", "voltcam_server.bench_receivers", name]
    with opened() as sender:
        process = subprocess.Popen([*command, sender.address, str(packet_bytes)], stdout=subprocess.PIPE)
        with process:
            reports = Reports(process)
            try:
                _greet(name, sender, reports, process)
                yield sender, reports
            finally:
                reports.end()


def _greet(name: str, sender: Sender, reports: Reports, process: "subprocess.Popen[bytes]") -> None:
    """Send now and then until something comes, and a little longer."""
    until_s = time.monotonic() + BEGIN_S
    while not reports.count:
        if process.poll() is not None or time.monotonic() > until_s:
            raise VoltcamError(f"{name}: its receiver has nothing within {BEGIN_S:g} s")
        sender.send(events_at(time.time_ns() // 1000, LATENCY_EVENTS))
        time.sleep(GREET_S)
    time.sleep(5 * GREET_S)
