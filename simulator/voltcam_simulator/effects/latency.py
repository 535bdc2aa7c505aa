"""Events leave the pixel some time after the voltage has reached the threshold."""

import math
from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import in_time_order
from ..kernel import kernel
from ..random import normals, sequences

WIDEST = 4.0  # standard deviations


class Latency(Effect):
    """t + delay + jitter N(0, 1), the normal number cut at 4, the pixel's own events in their order.

    Stamps may so be earlier than the light: the jitter of a clock is, and a negative delay is that of a
    camera whose events' clock runs ahead of its frames'. Events wait until no earlier one can come.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = "the lag behind the light shifts and spreads, the same at any brightness"
    steady: ClassVar[bool] = True

    delay_us: float = quantity(
        0.0, unit="us", ge=-100_000, le=1_000_000, meaning="mean delay",
        source="100 us (IEBCS, Joubert et al. 2021); DAVIS346 at least 20 us (data sheet)",
    )  # fmt: skip
    jitter_us: float = quantity(
        0.0, unit="us", ge=0, le=100_000, meaning="standard deviation of the delay",
        source="10 to 30 us (IEBCS, Joubert et al. 2021)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.delay_us != 0 or self.jitter_us > 0

    @property
    def earliest_us(self) -> int:
        return math.ceil(WIDEST * self.jitter_us - self.delay_us)

    def state(self, sensor: Sensor) -> State:
        return {"left_us": np.full(sensor.width * sensor.height, np.iinfo(np.int64).min, np.int64)}

    def report(self, events: Events, readout: EventInterval) -> Events:
        left_us = readout.state[self.name]["left_us"]
        key = readout.key(self.name)
        late_us = draw_delays(key, len(events), self.delay_us, self.jitter_us)
        delay(events, late_us, readout.sensor.width, left_us)
        return in_time_order(events)


@kernel
def draw_delays(key: Any, count: Any, mean: Any, jitter: Any) -> Any:
    """So many delays in whole microseconds, float64."""
    half = (count + 1) // 2
    states, late = np.empty(half, np.uint64), np.empty(2 * half)
    sequences(key, 0, np.arange(half), states)
    normals(states, late[:half], late[half:])
    for i in range(late.shape[0]):
        late[i] = math.floor(mean + jitter * max(-WIDEST, min(late[i], WIDEST)) + 0.5)
    return late[:count]


@kernel
def delay(events: Any, late: Any, width: Any, left: Any) -> None:
    """Delay the events, in place; left (pixels,) int64 [us]: when the last event of each pixel has left.

    Nothing else is in the loop, so that several misses of the cache are on their way at once.
    """
    for i in range(events.shape[0]):
        pixel = np.int64(events[i].y) * width + np.int64(events[i].x)
        leaves = max(events[i].t + np.int64(late[i]), left[pixel])
        left[pixel] = leaves
        events[i].t = leaves
