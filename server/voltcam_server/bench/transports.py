"""`voltcam bench transports`: how many events a second a receiver in its own process has, and how late.

Each transport stands beside a plain socket that carries as many bytes, measured in the same way at once after
it. So few packets are under way that nothing is dropped and memory is bounded. Where a receiver does not get
all, as with UDP, packets leave as fast as they can, and what arrives is counted.
"""

import contextlib
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.errors import VoltcamError

from .figure import REPEATS, Figure
from .plain import Sender
from .receivers import REPORT
from .senders import HEIGHT, SENDERS, WIDTH, Kind

PACKET_EVENTS = 8192  # a daemon's largest packet
LATENCY_EVENTS = 1000  # in packets of 1 ms: a million events a second
LOOK_S = 1.5  # at each of throughput and latency
BEGIN_S, LOST_S = 15.0, 0.5
PAUSE_S, GREET_S = 0.0002, 0.02
REPORTED = np.dtype([("events", "<i8"), ("newest_us", "<i8"), ("at_ns", "<i8")])


class Throughput(NamedTuple):
    """parts: what arrived a second, millions of events or pictures, in each of REPEATS parts of the look.

    sent: million events/s. arrived: share of the events that left; None where the receiver gets all.
    """

    parts: list[float]
    sent: float
    arrived: float | None

    @property
    def remark(self) -> str:
        return "" if self.arrived is None else f", {100 * self.arrived:.0f} % arrived"


def transports(look_s: float = LOOK_S) -> Iterator[Callable[[], list[Figure]]]:
    """What is measured, in order."""
    for name, kind in SENDERS.items():
        if kind.there:
            yield partial(beside_plain, name, kind, look_s)


def beside_plain(name: str, kind: Kind, look_s: float) -> list[Figure]:
    """Throughput and latency, of a transport and of a socket with as many bytes, where there is one."""
    unit = "pictures/s" if kind.pictures else "Mevents/s"
    ours, ours_ms = throughput(name, kind, look_s), latencies(name, kind, look_s)
    if kind.plain is None:
        remark = f"of {ours.sent:.3g} Mevents/s" if kind.pictures else ""
        return [Figure.of(f"{name} throughput", ours.parts, unit, remark), *late(name, ours_ms)]
    full, small = (kind.wire_bytes(events_at(0, count)) for count in (PACKET_EVENTS, LATENCY_EVENTS))
    plain, receiver = kind.plain, kind.plain_receiver
    limit = throughput(receiver, kind._replace(open=partial(plain, full)), look_s, full)
    limit_ms = latencies(receiver, kind._replace(open=partial(plain, small)), look_s, small)
    share = f"{np.median(ours.parts) / np.median(limit.parts):.2f} of the plain socket"
    return [
        Figure.of(f"{name} throughput", ours.parts, unit, share + ours.remark),
        Figure.of(f"{name}: plain socket, same bytes", limit.parts, unit, f"{full} bytes{limit.remark}"),
        *late(name, ours_ms),
        *late(f"{name}: plain socket", limit_ms),
    ]


def late(name: str, late_ms: NDArray[np.float64]) -> list[Figure]:
    """Median and 99th percentile of each of REPEATS parts."""
    parts = np.array_split(late_ms, REPEATS)
    return [
        Figure.of(f"{name} latency p{rank}", [float(np.percentile(part, rank)) for part in parts], "ms")
        for rank in (50, 99)
    ]


def throughput(receiver: str, kind: Kind, look_s: float, packet_bytes: int = 0) -> Throughput:
    """As fast as it goes. receiver: its name."""
    events = events_at(0, PACKET_EVENTS)
    with _receiving(receiver, kind, packet_bytes) as (sender, reports):
        begin, begin_s = reports.count, time.monotonic()
        gone = partial(_gone, kind, sender, reports)
        before = sent = gone()
        while time.monotonic() < begin_s + look_s:
            if sent - gone() < kind.ahead:
                sender.send(events)
                sent += 1
                continue
            if sender.taken is None and time.time_ns() - reports.last_ns > LOST_S * 1e9:
                sent = gone()  # the others are lost
            time.sleep(PAUSE_S)
        left_per_s = (gone() - before) * PACKET_EVENTS / (time.monotonic() - begin_s)
        time.sleep(LOST_S)  # what is under way
        left = (gone() - before) * PACKET_EVENTS
        rows = reports.rows(begin)
    parts = []
    for part in np.array_split(rows, REPEATS):
        span_ns = int(part["at_ns"][-1] - part["at_ns"][0])
        arrivals = part[1:].size * 1e6 if kind.pictures else int(part["events"][1:].sum())
        parts.append(arrivals / max(span_ns, 1) * 1e3)
    arrived = None if sender.taken is None or kind.pictures else int(rows["events"].sum()) / left
    return Throughput(parts, left_per_s / 1e6, arrived)


def _gone(kind: Kind, sender: Sender, reports: "Reports") -> float:
    """Packets that are no longer under way."""
    if sender.taken is not None:
        return sender.taken()
    return reports.count if kind.pictures else reports.events / PACKET_EVENTS


def latencies(receiver: str, kind: Kind, look_s: float, packet_bytes: int = 0) -> NDArray[np.float64]:
    """From just before a packet is published to when the receiver's program has it, ms."""
    with _receiving(receiver, kind, packet_bytes) as (sender, reports):
        begin, next_s = reports.count, time.monotonic()
        for _ in range(int(look_s / kind.period_s)):
            sender.send(events_at(time.time_ns() // 1000, LATENCY_EVENTS))
            next_s += kind.period_s
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
def _receiving(name: str, kind: Kind, packet_bytes: int) -> Iterator[tuple[Sender, Reports]]:
    """A sender, and the reports of a receiver in its own process that has begun to receive."""
    command = [sys.executable, "-m", "voltcam_server.bench.receivers", name]
    with kind.open() as sender:
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
