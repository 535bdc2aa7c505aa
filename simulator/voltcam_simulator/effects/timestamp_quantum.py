"""The clock that stamps the events ticks coarsely."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, quantity


class TimestampQuantum(Effect):
    """t = q floor(t / q). A stamp may so lie before the frame in whose interval the event came, by less than
    a quantum; the stream stays in order: where the quantum is changed, stamps wait for the next tick.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = "time stamps are multiples of the quantum"
    steady: ClassVar[bool] = True

    quantum_us: int = quantity(
        1, unit="us", ge=1, le=1_000_000, meaning="time between two ticks; 1 is off",
        source="1 us: DAVIS and libcaer",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.quantum_us > 1

    def stamp_us(self, t_us: int) -> int:
        return t_us // self.quantum_us * self.quantum_us

    def report(self, events: Events, readout: EventInterval) -> Events:
        t_us = np.ascontiguousarray(events["t"])
        events["t"] = t_us // self.quantum_us * self.quantum_us
        return events
