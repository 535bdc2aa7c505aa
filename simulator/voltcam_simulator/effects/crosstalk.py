"""An event disturbs the pixels beside it."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import copied
from ..kernel import kernel

LONG_AGO_US = -(2**62)


class Crosstalk(Effect):
    """Each event adds `coupling`, with its sign, to the voltages of its four neighbours; one that thereby
    passes its threshold fires in the same microsecond. What it sets off does not couple on (second order).

    Voltages are known at the end of the interval only, and but for their pending noise; these are used for
    all events of the interval. As many pixels are within reach of a threshold then as at any instant, so
    rates and coincidences come out right, but who fires is not exact. Dead times are kept: events that
    would fall into the dead time of one set off here are left out.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "at rest, neighbours fire together more often than by chance"

    feeds_back: ClassVar[bool] = True

    coupling: float = quantity(
        0.0, unit="nominal thresholds", ge=0, le=0.25, meaning="voltage from one neighbour's event; 0 is off",
        source="ours, below 0.01: no published value is known to us",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.coupling > 0

    def state(self, sensor: Sensor) -> State:
        return {"last_us": np.full(sensor.width * sensor.height, LONG_AGO_US, np.int64)}

    def report(self, events: Events, readout: EventInterval) -> Events:
        sensor, last_us = readout.sensor, readout.state[self.name]["last_us"]
        theta_on, theta_off = np.ascontiguousarray(sensor.theta_on), np.ascontiguousarray(sensor.theta_off)
        room = np.empty(5 * len(events), events.dtype)
        written = couple(
            events, self.coupling, theta_on, theta_off, readout.voltage, sensor.refractory_us, last_us, room
        )
        return copied(room[:written])


@kernel
def couple(
    events: Any, coupling: Any, theta_on: Any, theta_off: Any, voltage: Any, period: Any, last: Any, out: Any
) -> Any:
    """Copy the events to out (5 times as many), with those they set off. Returns how many there are.

    theta_on, theta_off (height, width), voltage (pixels,): changed; period [us]: dead time; last (pixels,)
    int64: time of the last event of each pixel. Times are whole microseconds, hence the + 1.
    """
    height, width = theta_on.shape
    written = 0
    for i in range(events.shape[0]):
        event = events[i]
        t, x, y = event.t, np.int64(event.x), np.int64(event.y)
        if t - last[y * width + x] + 1 < period:
            continue
        last[y * width + x] = t
        out[written] = event
        written += 1
        kick = np.float32(coupling if event.p else -coupling)
        for dx, dy in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            u, v = x + dx, y + dy
            if u < 0 or u >= width or v < 0 or v >= height:
                continue
            pixel = v * width + u
            raised = voltage[pixel] + kick
            if -theta_off[v, u] < raised < theta_on[v, u]:
                voltage[pixel] = raised
            elif t - last[pixel] + 1 >= period:
                voltage[pixel], last[pixel] = 0.0, t
                out[written] = event
                out[written].x, out[written].y, out[written].p = u, v, raised > 0
                written += 1
    return written
