"""A video frame is the mean of the light while it was exposed."""

import threading
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..effect import About, Band, Effect, Sensor, State, quantity
from ..kernel import kernel

SHORTEST_US = 1.0  # times are whole microseconds: a shorter mean is that of no time
KNOTS = 32
"""Instants of light that are kept; of an exposure longer than 31 steps only the last 31 count."""

_PLACING = threading.Lock()


class ExposureBlur(Effect):
    """The mean of the light over the last exposure_us, exact for light that goes straight from step to step.

    Such a mean is a weighted sum of the light at the ends of the steps, with the same weights for all pixels:
    the light there is kept for as long as an exposure may need it. (Memory not needed is not touched.)
    Between its own steps the mean is taken as a straight line: at a bend of the light by a share q of its
    slope, times are wrong by at most q/2 of the exposure or q/10 of the step, whichever is less.
    """

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = (
        "fast edges spread over the exposure: fewer, later events there, none elsewhere"
    )

    exposure_us: float = quantity(
        0.0, unit="us", ge=0, le=1e6, meaning="time over which a frame gathered its light",
        source="the camera's shutter: 500 (DAVIS346 street) up to the time between two frames",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.exposure_us >= SHORTEST_US

    def state(self, sensor: Sensor) -> State:
        lights = np.zeros((KNOTS, sensor.width * sensor.height), np.float32)
        return {"times_us": np.full(KNOTS, -np.inf), "lights": lights}

    def see(self, band: Band) -> None:
        own = band.planes[self.name]
        times_us: NDArray[np.float64] = own["times_us"]
        if band.span_us == 0:  # the image has been there for long
            times_us[:] = -np.inf
            times_us[0] = band.end_us
            band.apply(keep, band.light, 0, own["lights"])
            return
        begin_us = band.end_us - self.exposure_us
        with _PLACING:  # bands of one step share the times, and several threads work on bands
            now = place(times_us, begin_us, band.end_us)
        known = np.flatnonzero(times_us > -np.inf)
        known = known[np.argsort(times_us[known])]
        weight = weights(times_us[known], begin_us)
        counts = weight != 0
        band.apply(keep, band.light, now, own["lights"])
        band.apply(average, own["lights"], known[counts], weight[counts].astype(np.float32), band.light)


@kernel
def keep(light: Any, index: Any, lights: Any) -> None:
    """Row `index` of lights becomes the light."""
    for i in range(light.shape[0]):
        lights[index, i] = light[i]


@kernel
def average(lights: Any, rows: Any, weight: Any, light: Any) -> None:
    """The light becomes the sum of some rows of lights, weighted."""
    for i in range(light.shape[0]):
        light[i] = 0
    for k in range(rows.shape[0]):
        row = lights[rows[k]]
        for i in range(light.shape[0]):
            light[i] += weight[k] * row[i]


def place(times_us: NDArray[np.float64], begin_us: float, end_us: float) -> int:
    """The index at which the light of end_us belongs; times_us, what each holds, is brought up to date."""
    now = np.flatnonzero(times_us == end_us)
    if now.size:  # another band of this step was here before
        return int(now[0])
    oldest_needed = times_us[times_us <= begin_us].max(initial=-np.inf)
    free = np.flatnonzero((times_us < oldest_needed) | (times_us == -np.inf))
    index = int(free[0] if free.size else times_us.argmin())
    times_us[index] = end_us
    return index


def weights(times_us: NDArray[np.float64], begin_us: float) -> NDArray[np.float64]:
    """Weights of the values at ascending times in the mean from begin_us to the last of them.

    The values are joined by straight lines; before the first of them they are what they are there.
    """
    first, last = times_us[:-1], times_us[1:]
    begin = np.clip(begin_us, first, last)
    share = ((begin + last) / 2 - first) / (last - first)  # of the last value in the mean over the rest
    result = np.zeros(times_us.size)
    result[1:] += (last - begin) * share
    result[:-1] += (last - begin) * (1 - share)
    result[0] += max(times_us[0] - begin_us, 0)
    result /= times_us[-1] - begin_us
    return result
