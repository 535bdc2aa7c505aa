"""Several steps of a small sensor in one call: what each call costs is then shared by them.

Effects that are all `instant` see them as one band, as tall as the steps together. Voltages are then followed
step by step, with the same random numbers and the same arithmetic as one step at a time.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .band_state import BandState
from .band_step import BandStepper
from .crossings import cross
from .effect import Band, Image, Sensor
from .fixed_pattern import FixedPattern
from .groups import Reset
from .kernel import kernel
from .out_of_reach import accumulate
from .random import CROSSINGS, key_of_interval


class SeveralSteps:
    """Takes the only band of a sensor through up to `most` steps at once, by planes (most, pixels).

    Drift and noise are made in one call for all steps in a row that are of the same length.
    """

    def __init__(self, pattern: FixedPattern, stepper: BandStepper, most: int) -> None:
        self._sensor: Sensor = pattern.sensor
        self._stepper = stepper
        self._reset = Reset(pattern.sensor.refractory_us, pattern.sensor.reset_sigma)
        pixels = pattern.sensor.width * pattern.sensor.height
        self._light = np.empty((most + 1, pixels), np.float32)  # and that before
        self._planes = np.empty((3, most, pixels), np.float32)
        leak = pattern.sensor.leak
        self._leak = None if leak is None else np.tile(leak.ravel(), most)

    @property
    def nbytes(self) -> int:
        """Memory of the planes."""
        leak = 0 if self._leak is None else self._leak.nbytes
        return self._light.nbytes + self._planes.nbytes + leak

    def draw(
        self, state: BandState, images: Sequence[Image], spans_us: NDArray[np.float64], offset_us: float,
        seed: int, first_step: int,
    ) -> None:  # fmt: skip
        """From image to image: event keys go into the band's workspace, its last light and response become
        those at the end. The first step starts offset_us into the interval and has the number first_step."""
        steps, light = len(images), self._light
        light[0] = state.light
        for step, image in enumerate(images, start=1):
            light[step] = image.ravel()
        self._stepper.respond(self._band(0, steps, 0.0))
        edges = [0, *(np.flatnonzero(np.diff(spans_us)) + 1).tolist(), steps]
        for begin, end in pairwise(edges):
            self._stepper.add_drift(self._band(begin, end, float(spans_us[begin])))
        offsets_us = offset_us + np.cumsum(spans_us) - spans_us
        response, drift, noise = self._planes[:, :steps]
        near, bent, place = state.workspace.near, state.workspace.bent, np.array([-1, 0])
        state.workspace.draw(steps, lambda done, keys: follow_steps(
            *state.pixels, response, drift, noise, state.response, spans_us, offsets_us, np.uint64(seed),
            np.uint64(first_step), state.width, *self._reset, *state.no_kicks, state.rows.ahead, near, bent,
            state.has_held, done, place, keys,
        ))  # fmt: skip
        state.light[:] = light[steps]

    def _band(self, begin: int, end: int, span_us: float) -> Band:
        """Some steps of the same length as one tall band."""
        before, light = self._light[begin:end].ravel(), self._light[begin + 1 : end + 1].ravel()
        response, drift, noise = self._planes[:, begin:end].reshape(3, -1)
        leak = None if self._leak is None else self._leak[: light.size]
        return Band(
            self._sensor, 0, 0, span_us, 0.0, self._sensor.temperature_c, before, light, response, drift,
            noise, bow=drift, rate=noise, leak=leak,
        )  # fmt: skip


@kernel
def follow_steps(
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, response: Any, drift: Any, noise: Any,
    last_response: Any, spans_us: Any, offsets_us: Any, seed: Any, first_step: Any, width: Any, dead_us: Any,
    sigma: Any, kick_times_us: Any, kick_sizes: Any, slack: Any, ahead: Any, near: Any, bent: Any,
    careful: Any, first: Any, place: Any, keys: Any,
) -> Any:  # fmt: skip
    """Let voltages go through the steps from `first` on; response, drift, noise (steps, n).

    place (2,) int64: how many pixels of the first step are near a threshold, -1 for not known, and how many
    of these are done. Returns (steps done, events written); stops where keys is full.
    """
    written = 0
    for step in range(first, spans_us.shape[0]):
        span_us = spans_us[step]
        if place[0] < 0:
            add_change(response[step], last_response, drift[step])
            place[0], _ = accumulate(
                voltage, pending, held, above, below, drift[step], noise[step], None, span_us, width, ahead,
                near, bent,
            )  # fmt: skip
        key = key_of_interval(seed, CROSSINGS, first_step + np.uint64(step))
        place[1], more = cross(
            voltage, pending, held, above, below, drift[step], noise[step], key, span_us, offsets_us[step], 0,
            width, dead_us, sigma, kick_times_us, kick_sizes, slack, None, None, careful, near[: place[0]],
            bent[:0], place[1], keys[written:],
        )  # fmt: skip
        written += more
        if place[1] < place[0]:
            return step, written
        place[0], place[1] = -1, 0
    return spans_us.shape[0], written


@kernel
def add_change(response: Any, last_response: Any, drift: Any) -> None:
    """Add the change of response to the drift; the new response becomes the last. (n,)."""
    for i in range(drift.shape[0]):
        drift[i] += response[i] - last_response[i]
        last_response[i] = response[i]
