"""Noise at rest comes in pairs: an event, and soon after it one of the other polarity."""

import math
from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, quantity
from ..event_order import in_time_order, merged
from ..kernel import kernel
from ..random import uniform


class NoisePairs(Effect):
    """Pairs ON-OFF and OFF-ON at random times, most in the dark: rate / (1 + L / half).

    The noise of the photoreceptor is bounded and coloured (second order: Graca and Delbruck 2021). A peak of
    it fires and the pixel memorises the peak; when the noise has returned, the pixel stands a threshold away
    and fires the opposite (McReynolds, Graca, Delbruck 2023). What comes of that is laid on the events: the
    second follows after the dead time and an exponential wait. The pixels' voltages know nothing of it.
    L is taken at the end of the interval.
    """

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "short ON-OFF and OFF-ON intervals of one pixel at rest, most in the dark"
    steady: ClassVar[bool] = True

    sees_light: ClassVar[bool] = True

    rate_hz: float = quantity(
        0.0, unit="Hz", ge=0, le=10_000, meaning="pairs a second and pixel in the dark; 0 is off",
        source="4 in the dark: 5.0 ON and 3.7 OFF Hz at 0.1 lux (IEBCS, Joubert et al. 2021)",
    )  # fmt: skip
    half_dn: float = quantity(
        10.0, unit="DN", gt=0, le=100_000, meaning="brightness at which there are half as many",
        source="falls with light: Graca and Delbruck (2021); the form is ours",
    )  # fmt: skip
    interval_us: float = quantity(
        5000.0, unit="us", gt=0, le=1e7, meaning="mean wait for the second event, after the dead time",
        source="time constant of a pixel in the dark, 1/(2 pi 30 Hz): 30 Hz in v2e (Hu et al. 2021)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.rate_hz > 0

    def prepare(self, sensor: Sensor) -> None:
        sensor.own[self.name] = {"alive": np.isfinite(sensor.theta_on).ravel()}

    def report(self, events: Events, readout: EventInterval) -> Events:
        sensor, span_us, key = readout.sensor, readout.span_us, readout.key(self.name)
        rate_per_us = 1e-6 * self.rate_hz * sensor.width * sensor.height
        return merged(events, in_time_order(readout.filled(
            2 * rate_per_us * span_us,
            lambda own: fire_pairs(
                key, rate_per_us, readout.light, sensor.own[self.name]["alive"], self.half_dn,
                sensor.refractory_us, self.interval_us, readout.start_us, span_us, sensor.width, own,
            ),
        )))  # fmt: skip


@kernel
def fire_pairs(
    key: Any, rate: Any, light: Any, alive: Any, half: Any, dead: Any, wait: Any, start: Any, span: Any,
    width: Any, events: Any,
) -> Any:  # fmt: skip
    """The pairs that begin in a span: as many as in the dark, rate [1/us] for all pixels, then fewer where
    it is bright. Returns how many events there are, of which events has as many as it takes."""
    count, pixels = 0, light.shape[0]
    state, u = uniform(key)
    t = -math.log(u) / rate
    while t < span:
        state, u = uniform(state)
        pixel = min(np.int64(u * pixels), pixels - 1)
        state, u = uniform(state)
        if alive[pixel] and u * (1.0 + light[pixel] / half) < 1.0:
            state, u = uniform(state)
            state, on = uniform(state)
            if count + 1 < events.shape[0]:
                first = start + np.int64(t)
                events[count].t, events[count].p = first, on < 0.5
                events[count + 1].t = first + np.int64(math.ceil(dead - wait * math.log(u)))
                events[count + 1].p = on >= 0.5
                for k in range(count, count + 2):
                    events[k].x, events[k].y = pixel % width, pixel // width
            count += 2
        state, u = uniform(state)
        t -= math.log(u) / rate
    return count
