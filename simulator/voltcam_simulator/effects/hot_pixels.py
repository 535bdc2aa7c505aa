"""Pixels that fire by themselves, whatever they see."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, quantity
from ..event_order import events_at, merged

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
        sensor.own[self.name] = {"pixel": pixel[hot], "rate_hz": rate_hz}

    def report(self, events: Events, readout: EventInterval) -> Events:
        hot, rng = readout.sensor.own[self.name], readout.generator(self.name)
        counts = rng.poisson(hot["rate_hz"] * readout.span_us * 1e-6)
        if not counts.any():  # the rule where frames are many and pixels few: save ten calls
            return events
        readout.admit(counts.sum())
        pixel = np.repeat(hot["pixel"], counts)
        t_us = rng.integers(readout.start_us, readout.end_us, len(pixel))
        on = rng.random(len(pixel)) < self.on_share
        return merged(events, events_at(t_us, pixel, on, readout.sensor.width))
