"""Lamps on the mains."""

import math
from typing import ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..plane_kernels import scale

STEPS_PER_PERIOD = 16
"""A straight line over a step misses the sine by at most (pi/16)^2/2, that is 2 %, of its amplitude."""


class Flicker(Effect):
    """Light times 1 + depth sin(2 pi (frequency_hz t + phase_turns)), t from the time line's zero: no jump
    at any frame."""

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = (
        "a line in the spectrum of event times at the lamp's frequency, ON and OFF half a period apart"
    )

    frequency_hz: float = quantity(
        100.0, unit="Hz", gt=0, le=10_000, meaning="frequency of the light: twice that of the mains",
        source="100 Hz in Europe, 120 Hz in America",
    )  # fmt: skip
    depth: float = quantity(
        0.0, unit="1", ge=0, le=1, meaning="amplitude relative to the mean light",
        source="fluorescent and incandescent lamps 0.05 to 0.3 (IEEE 1789-2015)",
    )  # fmt: skip

    phase_turns: float = quantity(
        0.0, unit="periods", ge=-1, le=1, meaning="phase at the zero of the time line; 0.25: brightest",
        source="the lamp's; voltcam diagnose finds it",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.depth > 0

    @property
    def longest_step_us(self) -> float:
        return 1e6 / self.frequency_hz / STEPS_PER_PERIOD

    def see(self, band: Band) -> None:
        period_us = 1e6 / self.frequency_hz
        phase = math.fmod(band.end_us, period_us) / period_us  # exact, at any distance from zero
        factor = 1 + self.depth * math.sin(2 * math.pi * (phase + self.phase_turns))
        band.apply(scale, band.light, np.float32(factor))
