"""When events leave: an interval's events in packets, each at its own time during the next interval."""

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .camera_settings import PacketSettings
from .interval import Interval

BURST_PACKET_US = 1_000_000  # some encodings hold a few seconds only
RECENT = 64  # intervals, a second or two of most sources: few enough to follow a change, enough for ENOUGH
ENOUGH = 0.75  # of them are not held up by the pace; 1 would have all events as late as the slowest one
QUEUE_INTERVALS = 2


@dataclass(frozen=True, slots=True, eq=False)
class Slice:
    """Successive events of one interval: those from start_us on, complete at end_us."""

    events: NDArray[np.void]
    start_us: int
    end_us: int


def slices(interval: Interval, packets: PacketSettings) -> Iterator[Slice]:
    """The interval's events in order, in slices no longer than the settings allow; without events, one empty.

    Slices are cut at multiples of the packet time after the interval's start, and empty ones left out.
    """
    # The times on their own: `searchsorted` would copy them out of the records again for each slice.
    events, t = interval.events, np.ascontiguousarray(interval.events["t"])
    step_us = packets.packet_us if packets.smooth and interval.paced else BURST_PACKET_US
    done, former_end_us = 0, interval.start_us
    if not events.size:
        yield Slice(events, interval.start_us, interval.end_us)
    while done < events.size:
        start_us = interval.start_us + (int(t[done]) - interval.start_us) // step_us * step_us
        until = int(np.searchsorted(t, start_us + step_us))
        full = until - done > packets.packet_events
        until = min(until, done + packets.packet_events)
        end_us = int(t[until - 1]) if full else min(start_us + step_us, interval.end_us)
        yield Slice(events[done:until], max(start_us, former_end_us), end_us)
        done, former_end_us = until, end_us


class PlayOut:
    """Maps the events' time to `time.monotonic()`: so late that nearly all are there before they are due.

    The delay is what ENOUGH of the RECENT intervals needed. Events of one that needs more leave as soon as
    they are there, and those behind them at their own time: one late frame does not hold up all that follow.
    """

    def __init__(self) -> None:
        self._needed_s: deque[float] = deque(maxlen=RECENT)
        self._offset_s: float | None = None

    def begin(self, start_us: int, end_us: int, ready_s: float) -> None:
        """An interval whose events were known at `ready_s` is next."""
        needed_s, span_s = ready_s - start_us / 1e6, (end_us - start_us) / 1e6
        if self._offset_s is not None and not -span_s < self._offset_s - needed_s < span_s:
            self._needed_s.clear()  # the source paused, or its clock was set
        self._needed_s.append(needed_s)
        in_order = sorted(self._needed_s)
        self._offset_s = in_order[math.ceil(ENOUGH * len(in_order)) - 1]

    def due_s(self, t_us: int) -> float:
        """When the events up to `t_us` leave."""
        assert self._offset_s is not None
        return self._offset_s + t_us / 1e6


class Pacer:
    """A thread that gives out slices when they are due, and each interval when all of it has left.

    It drops nothing. When QUEUE_INTERVALS further ones are there already, what is left of the present one
    goes at once, and `put` waits.
    """

    def __init__(
        self,
        packets: PacketSettings,
        on_slice: Callable[[Interval, Slice], None],
        on_end: Callable[[Interval], None],
    ) -> None:
        self._packets = packets
        self._on_slice, self._on_end = on_slice, on_end
        self._queue: deque[Interval] = deque()
        self._changed = threading.Condition()
        self._stopping = False

    def put(self, interval: Interval) -> None:
        with self._changed:
            while len(self._queue) >= QUEUE_INTERVALS and not self._stopping:
                self._changed.wait()
            self._queue.append(interval)
            self._changed.notify_all()

    @property
    def waiting(self) -> int:
        """How many intervals wait for their turn."""
        return len(self._queue)

    def stop(self) -> None:
        """End `run`, and leave what has not left."""
        with self._changed:
            self._stopping = True
            self._changed.notify_all()

    def run(self) -> None:
        """Until `stop`."""
        play_out = PlayOut()
        while (interval := self._next()) is not None:
            smooth = self._packets.smooth and interval.paced
            if smooth:
                play_out.begin(interval.start_us, interval.end_us, interval.ready_s)
            for piece in slices(interval, self._packets):
                if smooth:
                    self._wait_until(play_out.due_s(piece.end_us))
                if self._stopping:
                    return
                self._on_slice(interval, piece)
            self._on_end(interval)

    def _next(self) -> Interval | None:
        with self._changed:
            while not self._queue and not self._stopping:
                self._changed.wait()
            self._changed.notify_all()
            return None if self._stopping else self._queue.popleft()

    def _wait_until(self, due_s: float) -> None:
        with self._changed:
            while (
                (wait_s := due_s - time.monotonic()) > 0
                and not self._stopping
                and len(self._queue) < QUEUE_INTERVALS
            ):
                self._changed.wait(wait_s)
