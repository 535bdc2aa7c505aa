"""An arbiter that goes round: a token passes over the rows; what waits in a row leaves when it comes by."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import in_time_order
from ..kernel import kernel
from ..random import events_key, uniform

NS_PER_US = 1000
SLOT_US, SLOTS = 1000, 4
"""The load is the mean of so many last slots, all after the last burst."""
OFTEN = 0.1
"""How often the arbiter goes over, a slot, at the load `busy_per_us`."""
BURST_US = 300.0
"""Over about what time the load of a burst is a mean: as long as what an exposure makes."""
_MEASURED = "measured on slider_depth (DAVIS240C, Event Camera Dataset), from the events' stamps and rows"


class ArbiterScan(Effect):
    """While the token goes round, an event waits until it passes its rows, from row 0 up, once in round_us;
    all that wait in these leave together. `readout` then takes them row by row.

    The arbiter goes over to that by chance, and far more often where the load is high: once in 10 ms times
    (busy_per_us / load) ^ steepness. Its load is the mean of the last four milliseconds. A burst such as a
    frame's exposure makes ends it, and so does a millisecond in which nothing asks; for four milliseconds at
    least. The token's place is counted from the time line's zero.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = (
        "events run over the rows, round after round, many of a row with one time stamp"
    )
    steady: ClassVar[bool] = True

    round_us: float = quantity(
        0.0, unit="us", ge=0, le=100_000, meaning="time of a round over all rows; 0 is off",
        source=f"199 to 275, 247 in the middle: {_MEASURED}",
    )  # fmt: skip
    rows_together: int = quantity(
        1, unit="1", ge=1, le=64, meaning="rows that the token passes at once",
        source=f"2: {_MEASURED}",
    )  # fmt: skip
    busy_per_us: float = quantity(
        0.0, unit="1/us", ge=0, le=1000,
        meaning="events to read at which the token begins its rounds once in 10 ms; 0: it always goes round",
        source=f"0.41: {_MEASURED}",
    )  # fmt: skip
    steepness: float = quantity(
        7.0, unit="1", ge=0, le=30, meaning="power of the load with which rounds begin",
        source=f"7, 5 to 9: {_MEASURED}",
    )  # fmt: skip
    burst_per_us: float = quantity(
        1.0, unit="1/us", gt=0, le=1000, meaning="events to read, over 0.3 ms, that end the rounds",
        source=f"between 0.7 and 1.6: a frame's exposure ends them, and nothing else: {_MEASURED}",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.round_us > 0

    def state(self, sensor: Sensor) -> State:
        return {
            "round": np.zeros(1, np.bool_),  # whether it goes round
            "counts": np.zeros(SLOTS + 1, np.int64),  # events of the last slots, and of the one at hand
            "burst_per_us": np.zeros(1),
            "clock": np.zeros(2, np.int64),  # time of the last event [us]; slots since a burst or silence
            "draws": np.array([events_key(sensor.seed, self.name, 0)], np.uint64),
        }

    def report(self, events: Events, readout: EventInterval) -> Events:
        state = readout.state[self.name]
        wait(
            events, np.int64(max(round(self.round_us * NS_PER_US), 1)), readout.sensor.height,
            self.rows_together, self.busy_per_us, self.steepness, self.burst_per_us, state["round"],
            state["counts"], state["burst_per_us"], state["clock"], state["draws"],
        )  # fmt: skip
        return in_time_order(events)


@kernel
def wait(
    events: Any, round_ns: Any, rows: Any, together: Any, busy: Any, steepness: Any, most: Any, going: Any,
    counts: Any, burst: Any, clock: Any, draws: Any,
) -> None:  # fmt: skip
    """Delay the events, in place and sorted by time, to when the token passes their rows, if it goes round.

    going (1,), counts (SLOTS + 1,), burst (1,), clock (2,), draws (1,): kept between.
    """
    for i in range(events.shape[0]):
        now = events[i].t * NS_PER_US
        if busy > 0:
            look(events[i].t, busy, steepness, most, going, counts, burst, clock, draws)
        if going[0] or busy == 0:
            passes = np.int64(events[i].y // together * together) * round_ns // rows
            events[i].t = (now + (passes - now) % round_ns) // NS_PER_US


@kernel
def look(
    t: Any, busy: Any, steepness: Any, most: Any, going: Any, counts: Any, burst: Any, clock: Any, draws: Any
) -> None:
    """Whether it goes round when an event comes at t [us], by the load up to then."""
    burst[0] *= np.exp(-max(t - clock[0], 0) / BURST_US)  # times may begin before zero
    if burst[0] > most:
        going[0], clock[1] = False, -1
    for _ in range(min(t // SLOT_US - clock[0] // SLOT_US, SLOTS + 1)):
        if counts[-1] == 0:
            going[0], clock[1] = False, -1
        counts[:-1] = counts[1:]
        counts[-1] = 0
        clock[1] += 1
        draws[0], u = uniform(draws[0])
        load = counts[:-1].mean() / SLOT_US
        going[0] |= clock[1] >= SLOTS and u < OFTEN * (load / busy) ** steepness
    burst[0] += 1 / BURST_US
    counts[-1] += 1
    clock[0] = t
