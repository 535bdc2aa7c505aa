"""A row asks for the bus some time after its first event; what comes to it until then leaves with that."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import in_time_order
from ..kernel import kernel
from ..random import events_key, uniform


class RowRequest(Effect):
    """An event of a row that does not ask yet makes it ask after an exponential time, wait_us in the mean.

    All events of the row up to then have that time: `readout` takes them together. So a row is hardly ever
    read twice within a few microseconds, and more of its events share their stamps.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = "no row is read twice within microseconds, and neighbours share their stamps"
    steady: ClassVar[bool] = True

    wait_us: float = quantity(
        0.0, unit="us", ge=0, le=10_000,
        meaning="mean time from a row's first event to its request; 0 is off",
        source="4.4: slider_depth (DAVIS240C), by times between events of a row, less the start of the bus",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.wait_us > 0

    def state(self, sensor: Sensor) -> State:
        return {
            "asks_us": np.full(sensor.height, np.iinfo(np.int64).min, np.int64),
            "draws": np.array([events_key(sensor.seed, self.name, 0)], np.uint64),
        }

    def report(self, events: Events, readout: EventInterval) -> Events:
        state = readout.state[self.name]
        together(events, self.wait_us, state["asks_us"], state["draws"])
        return in_time_order(events)


@kernel
def together(events: Any, wait_us: Any, asks_us: Any, draws: Any) -> None:
    """Give the events, sorted by time, the time at which their row asks, in place. asks_us (rows,): when each
    row asks next or asked last, draws (1,): kept between."""
    for i in range(events.shape[0]):
        t, y = events[i].t, np.int64(events[i].y)
        if t > asks_us[y]:
            draws[0], u = uniform(draws[0])
            asks_us[y] = t + np.int64(-wait_us * np.log(u) + 0.5)
        events[i].t = asks_us[y]
