"""The arbiter: all pixels share one bus, on which a row at a time is read."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import copied
from ..kernel import kernel

_FIT = "fit to the fullest 100 us of slider_depth (DAVIS240C): row_us 0.28, event_us 0.11"


class Readout(Effect):
    """One queue of rows. A row asks for the bus when its first event comes, and is served in the order of
    asking: all events that wait in it leave together, with the time of the grant, by rising x; then the
    bus is busy for row_us + event_us for each of them.

    A pixel holds one event; while that waits, it fires no other: such an event is lost. (The real
    pixel is reset when it is read, and memorises the level of then.)
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = (
        "a floor of global intervals, a cap on bursts, one time stamp for many of a row"
    )
    steady: ClassVar[bool] = True

    row_us: float = quantity(
        0.0, unit="us", ge=0, le=1000, meaning="bus time for each granted row", source=_FIT
    )
    event_us: float = quantity(
        0.0, unit="us", ge=0, le=1000, meaning="bus time for each event; 0 for both is off",
        source=f"1/12: DAVIS346 data sheet, 12 million events/s; {_FIT}",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.row_us > 0 or self.event_us > 0

    def state(self, sensor: Sensor) -> State:
        return {
            "held": np.zeros((sensor.height, sensor.width // 8 + 1), np.uint8),  # a bit: an event waits there
            "waiting": np.zeros((sensor.height, sensor.width), np.uint16),  # of each row: 2 x + polarity
            "counts": np.zeros(sensor.height, np.int64),  # and how many there are
            "queue": np.zeros(sensor.height, np.int64),  # a ring of the rows that ask
            "place": np.zeros(2, np.int64),  # where it begins, and its length
            "busy_us": np.zeros(1),  # how long the bus stays busy after the interval
        }

    def report(self, events: Events, readout: EventInterval) -> Events:
        bus = readout.state[self.name]
        out = np.empty(len(events) + int(bus["counts"].sum()), events.dtype)
        written = serve(
            events, readout.start_us, readout.span_us, self.row_us, self.event_us, bus["held"],
            bus["waiting"], bus["counts"], bus["queue"], bus["place"], bus["busy_us"], out,
        )  # fmt: skip
        return out if written == len(out) else copied(out[:written])


@kernel
def serve(
    events: Any, start: Any, span: Any, row_us: Any, event_us: Any, held: Any, waiting: Any, counts: Any,
    queue: Any, place: Any, busy_us: Any, out: Any,
) -> Any:  # fmt: skip
    """Serve what can be granted within the interval; the rest waits in the state. Returns events in out."""
    n, rows = events.shape[0], counts.shape[0]
    head, length, busy = place[0], place[1], busy_us[0]
    come, written = 0, 0
    while length > 0 or come < n:
        grant = busy if length > 0 else max(busy, np.float64(events[come].t - start))
        stamp = start + np.int64(grant)
        if length == 0 and grant <= span and (come + 1 == n or events[come + 1].t > stamp):
            out[written] = events[come]  # alone, as most are: the same as below, in a third of the time
            out[written].t = stamp
            come, written = come + 1, written + 1
            busy = grant + row_us + event_us
            continue
        while come < n and events[come].t <= stamp:
            x, y = np.int64(events[come].x), np.int64(events[come].y)
            bit = np.uint8(1 << (x & 7))
            if held[y, x >> 3] & bit == 0:
                held[y, x >> 3] |= bit
                waiting[y, counts[y]] = 2 * x + events[come].p
                if counts[y] == 0:
                    free = head + length
                    queue[free if free < rows else free - rows] = y
                    length += 1
                counts[y] += 1
            come += 1
        if grant > span:
            break
        row = queue[head]
        head, length = head + 1 if head + 1 < rows else 0, length - 1
        asking = waiting[row, : counts[row]]
        sort_few(asking)
        for k in range(asking.shape[0]):
            x = np.int64(asking[k] >> 1)
            out[written].t = stamp
            out[written].x, out[written].y, out[written].p = x, row, asking[k] & 1 != 0
            held[row, x >> 3] = 0
            written += 1
        busy = grant + row_us + event_us * counts[row]
        counts[row] = 0
    place[0], place[1] = head, length
    busy_us[0] = max(busy - span, 0.0)
    return written


@kernel
def sort_few(values: Any) -> None:
    """By insertion: most rows have one or two events waiting, for which a library sort takes 50 ns each."""
    for i in range(1, values.shape[0]):
        value, j = values[i], i
        while j > 0 and values[j - 1] > value:
            values[j] = values[j - 1]
            j -= 1
        values[j] = value
