"""The cable takes only so many events; when the buffer before it is full, the camera is blind for a while."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import copied
from ..kernel import kernel


class UsbOverflow(Effect):
    """A buffer that the cable empties at a constant rate. An event that finds it full is lost, and all after
    it until the buffer is empty (libcaer's default: drop on transfer stall, do not wait). Time stamps are
    given before the buffer: they do not change.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = "holes of the whole array, after more events than the cable can take"
    steady: ClassVar[bool] = True

    max_rate_events_per_s: float = quantity(
        0.0, unit="1/s", ge=0, le=1e10, meaning="what the cable can take; 0 is off",
        source="DAVIS240C: 40 MB/s of USB 2.0 at 6 bytes (time, row, column) for a single event",
    )  # fmt: skip
    buffer_events: int = quantity(
        16384, unit="events", ge=1, le=1_000_000_000, meaning="events the buffer holds",
        source="8 transfers of 8 KiB (libcaer's default) at 4 bytes an event",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.max_rate_events_per_s > 0

    def state(self, sensor: Sensor) -> State:
        return {"level": np.zeros(1), "stalled": np.zeros(1, np.bool_)}

    def report(self, events: Events, readout: EventInterval) -> Events:
        state, per_us = readout.state[self.name], self.max_rate_events_per_s * 1e-6
        kept = buffer(
            events,
            readout.start_us,
            readout.span_us,
            per_us,
            self.buffer_events,
            state["level"],
            state["stalled"],
        )
        return events if kept == len(events) else copied(events[:kept])


@kernel
def buffer(events: Any, start: Any, span: Any, per_us: Any, room: Any, level: Any, stalled: Any) -> Any:
    """Move what gets through to the front of events; returns how many. level, stalled (1,): kept between."""
    full, blind = level[0], stalled[0]
    kept, before = 0, 0
    for i in range(events.shape[0]):
        now = events[i].t - start
        full = max(full - per_us * (now - before), 0.0)
        before = now
        blind = full > 0.0 if blind else full + 1.0 > room
        if not blind:
            full += 1.0
            events[kept] = events[i]
            kept += 1
    level[0], stalled[0] = max(full - per_us * (span - before), 0.0), blind
    return kept
