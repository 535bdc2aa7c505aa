"""Pixels that fire by themselves, whatever they see."""

import math
from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, quantity
from ..event_order import in_time_order, merged
from ..kernel import kernel
from ..random import sequence, uniform

FASTEST_HZ = 1e6  # a pixel fires once in a microsecond at most: stamps are no finer


class HotPixels(Effect):
    """A few pixels fire as Poisson processes of their own, their rates log-normal; mostly ON, because what
    makes a pixel hot is a leaking reset switch. Raising `fraction` adds pixels, those before stay.
    """

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "the same few pixels top the list of rates, in the dark and without motion too"
    steady: ClassVar[bool] = True

    fraction: float = quantity(
        0.0, unit="1", ge=0, le=1, meaning="share of the pixels that are hot; 0 is off",
        source="ours, 0.001 to 0.01; none of the DAVIS240C of slider_depth fires above 30 Hz all the time",
    )  # fmt: skip
    rate_hz: float = quantity(
        10.0, unit="Hz", gt=0, le=100_000, meaning="median rate of the hot pixels",
        source="above the noise of all others: 0.2 Hz of leak, 10 Hz of shot noise (Guo, Delbruck 2022)",
    )  # fmt: skip
    spread_decades: float = quantity(
        0.3, unit="decades", ge=0, le=2, meaning="standard deviation of log10 of their rates",
        source="as other leak rates spread, 0.1 to 0.3 decades in v2e (Hu et al. 2021)",
    )  # fmt: skip
    on_share: float = quantity(
        0.95, unit="1", ge=0, le=1, meaning="share of ON among their events",
        source="a leaking reset switch gives ON: Nozaki and Delbruck (2017)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.fraction > 0

    def prepare(self, sensor: Sensor) -> None:
        rng, pixels = sensor.pattern(self.name), sensor.width * sensor.height
        pixel, spread = rng.permutation(pixels), rng.standard_normal(pixels)
        hot = slice(round(self.fraction * pixels))
        alive = np.isfinite(sensor.theta_on.ravel()[pixel[hot]])
        rate_hz = alive * np.minimum(self.rate_hz * 10 ** (self.spread_decades * spread[hot]), FASTEST_HZ)
        sensor.own[self.name] = {"pixel": pixel[hot], "rate_per_us": 1e-6 * rate_hz}

    def report(self, events: Events, readout: EventInterval) -> Events:
        hot, sensor, span_us = readout.sensor.own[self.name], readout.sensor, readout.span_us
        key, rate_per_us = readout.key(self.name), hot["rate_per_us"]
        return merged(events, in_time_order(readout.filled(
            float(rate_per_us.sum()) * span_us,
            lambda own: fire(
                key, hot["pixel"], rate_per_us, self.on_share, readout.start_us, span_us, sensor.width, own
            ),
        )))  # fmt: skip


@kernel
def fire(
    key: Any, pixel: Any, rate: Any, on_share: Any, start: Any, span: Any, width: Any, events: Any
) -> Any:
    """Each pixel's events of a span, after waits that are exponential; rate [1/us]. Returns how many there
    are, of which events has as many as it takes."""
    count = 0
    for i in range(pixel.shape[0]):
        state, u = uniform(sequence(key, i))
        t = -math.log(u) / rate[i]
        while t < span:
            state, u = uniform(state)
            if count < events.shape[0]:
                events[count].t, events[count].p = start + np.int64(t), u < on_share
                events[count].x, events[count].y = pixel[i] % width, pixel[i] // width
            count += 1
            state, u = uniform(state)
            t -= math.log(u) / rate[i]
    return count
