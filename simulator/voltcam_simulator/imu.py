"""The inertial measurement unit of a DAVIS at rest: gravity, noise, and the temperature of the die.

Figures: InvenSense MPU-6500, data sheet PS-MPU-6500A-01, typical values. Noise is white up to half the rate.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .random import events_generator

ACCEL_NOISE_G = 300e-6  # per root of Hz
GYRO_NOISE_DEG_S = 0.01  # per root of Hz
TEMPERATURE_STEPS = 333.87  # of its output per degree
GRAVITY_G = (0.0, -1.0, 0.0)  # of a camera that stands upright, y down: what holds it pushes it up

_BLOCK = 64  # samples that are drawn at a time


class ImuSamples(NamedTuple):
    """Times [us] (N,), temperature [C] (N,), acceleration [g] (N, 3), rotation [degree/s] (N, 3)."""

    t_us: NDArray[np.int64]
    temperature_c: NDArray[np.float64]
    accel_g: NDArray[np.float64]
    gyro_deg_s: NDArray[np.float64]


class ImuAtRest:
    """Samples at whole multiples of 1 / rate_hz on the events' time line; the same however that is cut."""

    def __init__(self, rate_hz: float, seed: int) -> None:
        self._rate_hz, self._seed = rate_hz, seed

    def samples(self, begin_us: int, end_us: int, temperature_c: float) -> ImuSamples:
        """Those with begin_us < t <= end_us."""
        number = np.arange(self._first_after(begin_us), self._first_after(end_us))
        noise = self._noise(number) * np.sqrt(self._rate_hz / 2)
        steps = np.rint(temperature_c * TEMPERATURE_STEPS) / TEMPERATURE_STEPS
        return ImuSamples(
            self._time_us(number),
            np.full(number.size, steps),
            GRAVITY_G + ACCEL_NOISE_G * noise[:, :3],
            GYRO_NOISE_DEG_S * noise[:, 3:],
        )

    def _time_us(self, number: NDArray[np.int64]) -> NDArray[np.int64]:
        t_us: NDArray[np.int64] = np.floor(number * (1e6 / self._rate_hz)).astype(np.int64)
        return t_us

    def _first_after(self, t_us: int) -> int:
        """Number of the first sample later than t_us."""
        number = max(0, int(t_us * self._rate_hz / 1e6) - 1)
        while self._time_us(np.array([number]))[0] <= t_us:
            number += 1
        return number

    def _noise(self, number: NDArray[np.int64]) -> NDArray[np.float64]:
        """Six standard normal numbers for each sample, by its number alone."""
        if not number.size:
            return np.empty((0, 6))
        first, last = int(number[0]) // _BLOCK, int(number[-1]) // _BLOCK
        blocks = [
            events_generator(self._seed, "imu", block).standard_normal((_BLOCK, 6))
            for block in range(first, last + 1)
        ]
        begin = int(number[0]) - first * _BLOCK
        return np.concatenate(blocks)[begin : begin + number.size]
