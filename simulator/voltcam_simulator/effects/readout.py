"""The arbiter: all pixels share one bus, on which a row at a time is read, or a column."""

from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from ..arbiters import ARBITERS, FIRST, TOKEN, change_to, join, next_in_tree, none_asking
from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import copied
from ..kernel import kernel
from ..random import events_key, uniform

Arbiter = Literal["first", "fair", "greedy", "token"]
_FIT = "fit to the fullest 100 us of slider_depth (DAVIS240C): row_us 0.28, event_us 0.11"


class Readout(Effect):
    """One bus for all rows. A row asks for it when its first event comes; when it is granted, all events that
    wait in the row leave together, with the time of the grant, by rising x; then the bus is busy for
    row_us + event_us for each of them. With `along: columns` it is columns that ask, by rising y.
    A bus that was idle grants later by start_us, exponential: others that ask meanwhile follow at once.

    Who is granted next (`arbiter`):
    - first: who has asked first.
    - fair: a tree in which of two sides that ask the one goes first that was not served last.
    - greedy: the same, but the nearest in the tree to the last one goes first; it serves what lies together.
    - token: a token goes round the rows upwards, stays at the last one while none asks, and needs pass_us for
      each row that it passes.

    From `crowd` rows on that ask, `crowded_arbiter` takes over until none does. A pixel holds one event;
    while that waits, it fires no other: such an event is lost. (The real pixel is reset when it is read, and
    memorises the level of then.)
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
        0.0, unit="us", ge=0, le=1000, meaning="bus time for each event; 0 for all of the times is off",
        source=f"1/12: DAVIS346 data sheet, 12 million events/s; {_FIT}",
    )  # fmt: skip
    start_us: float = quantity(
        0.0, unit="us", ge=0, le=1000, meaning="mean time in which a bus that was idle begins to grant",
        source="1.3: slider_depth (DAVIS240C), of all milliseconds without a token and without a burst",
    )  # fmt: skip
    along: Literal["rows", "columns"] = Field(
        "rows",
        description="read at a time: a row, as in a DAVIS, or a column (Son et al., ISSCC 2017)",
    )
    arbiter: Arbiter = Field(
        "first",
        description="who is next: the first that asked, a fair tree (Boahen 2004; Linn et al. 2011), a "
        "greedy one (Boahen 1999), a token ring (Imam and Manohar 2011)",
    )
    pass_us: float = quantity(
        0.0, unit="us", ge=0, le=1000, meaning="time in which the token passes a row that does not ask",
        source="round_us of arbiter_scan over 180 rows of a DAVIS240C: 1.4",
    )  # fmt: skip
    crowd: float = quantity(
        0.0, unit="1", ge=0, le=8192, source="convention: 0, never",
        meaning="rows that ask, from which crowded_arbiter takes over until none does; 0: never",
    )  # fmt: skip
    crowded_arbiter: Arbiter = Field("token", description="who is next in a crowd")

    @property
    def active(self) -> bool:
        has_token = self.arbiter == "token" or (self.crowd > 0 and self.crowded_arbiter == "token")
        times_us = (self.row_us, self.event_us, self.start_us)
        return max(times_us) > 0 or (self.pass_us > 0 and has_token)

    def state(self, sensor: Sensor) -> State:
        bits = max(sensor.height * (sensor.width // 8 + 1), sensor.width * (sensor.height // 8 + 1))
        return {
            **none_asking(max(sensor.height, sensor.width)),
            "held": np.zeros(bits, np.uint8),  # a bit: an event waits there
            "waiting": np.zeros(sensor.height * sensor.width, np.uint16),  # of each row: 2 x + polarity
            "made_for": np.full(2, -1, np.int64),  # along, arbiter
            "busy_us": np.zeros(1),  # how long the bus stays busy after the interval
            "draws": np.array([events_key(sensor.seed, self.name, 0)], np.uint64),
        }

    def report(self, events: Events, readout: EventInterval) -> Events:
        bus, sensor = readout.state[self.name], readout.sensor
        by_column, kind = self.along == "columns", ARBITERS.index(self.arbiter)
        if bus["made_for"].tolist() != [by_column, kind]:
            _make_for(bus, sensor.height, sensor.width, by_column, kind)
        groups, members = (sensor.width, sensor.height) if by_column else (sensor.height, sensor.width)
        crowd = max(int(self.crowd), 1) if self.crowd > 0 else groups + 1
        out = np.empty(len(events) + int(bus["counts"].sum()), events.dtype)
        written = serve(
            events, by_column, readout.start_us, readout.span_us, members, self.row_us, self.event_us,
            self.start_us, self.pass_us, kind, ARBITERS.index(self.crowded_arbiter), crowd,
            bus["held"], bus["waiting"], bus["counts"][:groups], bus["ring"][:groups], bus["tree"],
            bus["turn"], bus["place"], bus["busy_us"], bus["draws"], out,
        )  # fmt: skip
        return out if written == len(out) else copied(out[:written])


def _make_for(bus: State, height: int, width: int, by_column: bool, kind: int) -> None:
    """Another arbiter takes over what waits: in the order of rows, or of columns."""
    was_column, waits = bool(bus["made_for"][0] == 1), bus["counts"].copy()
    group = np.repeat(np.arange(waits.size), waits)
    within = np.arange(group.size) - np.repeat(np.cumsum(waits) - waits, waits)
    code = bus["waiting"][group * (height if was_column else width) + within].astype(np.int64)
    member, p = code >> 1, code & 1
    if was_column != by_column:
        group, member = member, group
    bus["counts"][:], bus["held"][:] = 0, 0
    groups, members = (width, height) if by_column else (height, width)
    hold(group, member, p, members, bus["held"], bus["waiting"], bus["counts"])
    change_to(kind, bus["counts"][:groups], bus["ring"][:groups], bus["tree"])
    bus["place"][:] = 0, np.count_nonzero(bus["counts"]), 0, kind
    bus["made_for"][:] = by_column, kind


@kernel
def serve(
    events: Any, by_column: Any, start: Any, span: Any, members: Any, row_us: Any, event_us: Any,
    start_us: Any, pass_us: Any, usual: Any, crowded: Any, crowd: Any, held: Any, waiting: Any, counts: Any,
    ring: Any, tree: Any, turn: Any, place: Any, busy_us: Any, draws: Any, out: Any,
) -> Any:  # fmt: skip
    """Serve what can be granted within the interval; the rest waits in the state. Returns events in out.

    members: pixels of a group, a row or column. crowd: groups that ask from which the arbiter `crowded` takes
    over from the usual one.
    """
    n, busy, come, written = events.shape[0], busy_us[0], 0, 0
    head, asking, last, kind = place[0], place[1], place[2], place[3]
    stride = (members >> 3) + 1
    while asking > 0 or come < n:
        if asking == 0 and events[come].t - start > busy:
            busy = np.float64(events[come].t - start)
            if start_us > 0:
                draws[0], u = uniform(draws[0])
                busy -= start_us * np.log(u)
        grant = busy
        stamp = start + np.int64(grant)
        alone = asking == 0 and kind == FIRST and crowd > 1 and (come + 1 == n or events[come + 1].t > stamp)
        if alone and grant < span:  # as most are: the same as below, in a third of the time
            out[written] = events[come]
            out[written].t = stamp
            last = np.int64(events[come].x if by_column else events[come].y)
            come, written = come + 1, written + 1
            busy = grant + row_us + event_us
            continue
        while come < n and events[come].t <= stamp:
            x, y = np.int64(events[come].x), np.int64(events[come].y)
            g, m = (x, y) if by_column else (y, x)
            byte, bit = g * stride + (m >> 3), np.uint8(1 << (m & 7))
            if held[byte] & bit == 0:
                held[byte] |= bit
                waiting[g * members + counts[g]] = 2 * m + events[come].p
                if counts[g] == 0:
                    if kind == FIRST:
                        free = head + asking
                        ring[free if free < ring.size else free - ring.size] = g
                    elif kind != TOKEN:
                        join(tree, g)
                    asking += 1
                counts[g] += 1
            come += 1
        if grant >= span:
            break
        if asking >= crowd and kind != crowded:
            change_to(crowded, counts, ring, tree)
            head, kind = 0, crowded
        if kind == FIRST:
            last = ring[head]
            head = head + 1 if head + 1 < ring.size else 0
        elif kind != TOKEN:
            last = next_in_tree(kind, last, tree, turn)
        elif counts[last] == 0:
            last = last + 1 if last + 1 < counts.size else 0
            busy = grant + pass_us
            continue
        leaving = waiting[last * members : last * members + counts[last]]
        sort_few(leaving)
        for k in range(leaving.shape[0]):
            m = np.int64(leaving[k] >> 1)
            out[written].t = stamp
            out[written].x, out[written].y = (last, m) if by_column else (m, last)
            out[written].p = leaving[k] & 1 != 0
            held[last * stride + (m >> 3)] = 0
            written += 1
        busy = grant + row_us + event_us * counts[last]
        counts[last] = 0
        asking -= 1
        if asking == 0 and kind != usual:
            change_to(usual, counts, ring, tree)
            head, kind = 0, usual
    place[0], place[1], place[2], place[3] = head, asking, last, kind
    busy_us[0] = max(busy - span, 0.0)
    return written


@kernel
def hold(group: Any, member: Any, p: Any, members: Any, held: Any, waiting: Any, counts: Any) -> None:
    """Events (n,) wait in their pixels, one in each."""
    for i in range(group.shape[0]):
        g, m = group[i], member[i]
        held[g * ((members >> 3) + 1) + (m >> 3)] |= np.uint8(1 << (m & 7))
        waiting[g * members + counts[g]] = 2 * m + p[i]
        counts[g] += 1


@kernel
def sort_few(values: Any) -> None:
    """By insertion: most rows have one or two events waiting, for which a library sort takes 50 ns each."""
    for i in range(1, values.shape[0]):
        value, j = values[i], i
        while j > 0 and values[j - 1] > value:
            values[j] = values[j - 1]
            j -= 1
        values[j] = value
