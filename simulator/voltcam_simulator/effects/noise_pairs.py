"""Noise at rest comes in pairs: an event, and soon after it one of the other polarity."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, quantity
from ..event_order import events_at, merged


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

    def report(self, events: Events, readout: EventInterval) -> Events:
        rng, sensor = readout.generator(self.name), readout.sensor
        pixels = sensor.width * sensor.height
        number = rng.poisson(self.rate_hz * pixels * readout.span_us * 1e-6)
        readout.admit(2 * number)
        pixel = rng.integers(0, pixels, number)
        dark = rng.random(len(pixel)) * (1 + readout.light[pixel] / self.half_dn) < 1
        alive = np.isfinite(sensor.theta_on.ravel()[pixel])
        pixel = pixel[dark & alive]
        if not pixel.size:
            return events
        first_us = rng.integers(readout.start_us, readout.end_us, len(pixel))
        wait_us = sensor.refractory_us + rng.exponential(self.interval_us, len(pixel))
        on = rng.random(len(pixel)) < 0.5
        t_us = np.concatenate([first_us, first_us + np.ceil(wait_us).astype(np.int64)])
        pairs = events_at(t_us, np.tile(pixel, 2), np.concatenate([on, ~on]), sensor.width)
        return merged(events, pairs)
