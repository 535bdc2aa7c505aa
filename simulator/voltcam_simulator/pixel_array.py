"""All pixels of a sensor: their state planes, and one step of all of them, band of rows by band of rows."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .effect import Band, Effect, Plane, Sensor, State, overrides
from .paper_law import cross_by_paper
from .parameters import Parameters
from .pixel import cross, gather
from .random import CROSSINGS, START, interval_key
from .stationary import start_voltage

Law = Literal["exact", "paper"]
Keys = NDArray[np.uint64]

BAND_PIXELS = 16384  # the planes of a band stay in the processor's cache from effect to effect


class PixelArray:
    """State of width x height pixels, and what happens to it from one instant to the next."""

    def __init__(self, width: int, height: int, law: Law, seed: int) -> None:
        self.width, self.height, self.law, self.seed = width, height, law, seed
        pixels = width * height
        self.voltage = np.zeros(pixels, np.float32)
        self._pending = np.zeros(pixels, np.float32)  # variance gathered since a voltage was last drawn
        self._light, self._response = np.zeros(pixels, np.float32), np.zeros(pixels, np.float32)
        self._held = np.zeros(0, np.float32)
        self.state: dict[str, State] = {}
        rows = max(1, BAND_PIXELS // width)
        self._bands = [(row, min(row + rows, height)) for row in range(0, height, rows)]
        self._scratch = np.empty((5, rows * width), np.float32)
        self._free = np.zeros(rows * width, np.float32)
        self._near = np.empty(rows * width + 1, np.int32)
        self._keys = np.empty(8192, np.uint64)
        self._steps, self._elapsed_us = 0, 0.0

    def configure(self, parameters: Parameters) -> None:
        """Take on parameters: lay down the fixed pattern, keep the state of the effects that stay on."""
        theta_on, theta_off = np.ones((2, self.height, self.width), np.float32)
        dark_level_dn = parameters.contrast_response.k2_dn
        sensor = Sensor(
            self.width, self.height, self.seed, parameters.temperature_c, dark_level_dn, theta_on, theta_off
        )
        effects = [self._by_law(effect) for effect in parameters.effects() if effect.active]
        for effect in effects:
            effect.prepare(sensor)
        self.state = {
            e.name: self.state.get(e.name) or e.state(sensor) for e in effects if overrides(e, "state")
        }
        self._see, self._respond, self._drift = (
            [effect for effect in effects if overrides(effect, stage)]
            for stage in ("see", "respond", "drift")
        )
        self.effects, self.sensor = effects, sensor
        self.longest_step_us = min(effect.longest_step_us for effect in effects)
        self._above, self._below = sensor.theta_on.ravel(), sensor.theta_off.ravel()
        if sensor.refractory_us > 0 and self._held.size == 0:
            self._held = np.zeros_like(self.voltage)

    def _by_law(self, effect: Effect) -> Effect:
        """The paper's law is defined with the linearised response."""
        if self.law == "paper" and effect.name == "contrast_response":
            return effect.model_copy(update={"response": "linearised"})
        return effect

    def settle(self, image: Plane, t_us: int) -> None:
        """Show an image as if it had been there for long: light and response of that instant, no events."""
        for first_row, end_row in self._bands:
            pixels = slice(first_row * self.width, end_row * self.width)
            band = self._band(first_row, pixels, image[pixels], t_us, 0.0)
            self._light[pixels], self._response[pixels] = band.light, band.response

    def start(self, t_us: int) -> None:
        """Voltages of pixels that have watched the settled image for long; the paper's law starts at 0."""
        if self.law == "paper":
            return
        key = interval_key(self.seed, START, 0)
        for first_row, end_row in self._bands:
            pixels = slice(first_row * self.width, end_row * self.width)
            band = self._blank(first_row, pixels, t_us, 1.0)
            band.light[:], band.response[:] = self._light[pixels], self._response[pixels]
            self._add_drift(band)
            above, below = self._above[pixels], self._below[pixels]
            start_voltage(self.voltage[pixels], band.drift, band.noise, above, below, key, pixels.start)

    def step(self, image: Plane, start_us: int, offset_us: float, span_us: float, filled: int) -> int:
        """From the last instant to the next, at which the sensor sees `image` (pixels,) float32 DN.

        The step starts offset_us after start_us. Keys of its events, timed from start_us, go behind the
        `filled` first of `keys`; returns the new number.
        """
        key = interval_key(self.seed, CROSSINGS, self._steps)
        self._steps += 1
        for first_row, end_row in self._bands:
            pixels = slice(first_row * self.width, end_row * self.width)
            band = self._band(first_row, pixels, image[pixels], start_us + int(offset_us), span_us)
            self._add_drift(band)
            filled = self._events(band, pixels, key, offset_us, filled)
            self._light[pixels], self._response[pixels] = band.light, band.response
        self._elapsed_us += span_us
        return filled

    def keys(self, filled: int) -> Keys:
        """The first `filled` event keys."""
        return self._keys[:filled]

    def _blank(self, first_row: int, pixels: slice, start_us: int, span_us: float) -> Band:
        light, response, drift, noise, _ = self._scratch[:, : pixels.stop - pixels.start]
        drift[:], noise[:], response[:] = 0, 0, 0
        sensor = self.sensor
        return Band(
            sensor, first_row, start_us, span_us, self._elapsed_us, sensor.temperature_c,
            self._light[pixels], light, response, drift, noise,
            leak=None if sensor.leak is None else sensor.leak.ravel()[pixels],
            planes={
                name: {key: array[pixels] for key, array in state.items() if array.size == self.voltage.size}
                for name, state in self.state.items()
            },
        )  # fmt: skip

    def _band(self, first_row: int, pixels: slice, image: Plane, start_us: int, span_us: float) -> Band:
        """A band at the end of a step: light and response there."""
        band = self._blank(first_row, pixels, start_us, span_us)
        band.light[:] = image
        for effect in self._see:
            effect.see(band)
        for effect in self._respond:
            effect.respond(band)
        return band

    def _add_drift(self, band: Band) -> None:
        for effect in self._drift:
            effect.drift(band)
        if band.noise2 is not None:
            np.sqrt(band.noise * band.noise + band.noise2, out=band.noise)

    def _events(self, band: Band, pixels: slice, key: np.uint64, offset_us: float, filled: int) -> int:
        voltage, above, below = self.voltage[pixels], self._above[pixels], self._below[pixels]
        drift, noise, span_us = band.drift, band.noise, band.span_us
        if self._respond:
            drift += band.response
            drift -= self._response[pixels]
        done, count, sensor = 0, voltage.size, self.sensor
        if self.law == "exact":
            pending, near = self._pending[pixels], self._near
            held = self._held[pixels] if self._held.size else self._free[: voltage.size]
            times, sizes = kick_arrays(band)
            slack = np.float32(np.abs(sizes).sum())
            count = gather(
                voltage, pending, drift, noise, np.float32(span_us), above, below, held, slack, near
            )
        while done < count:
            keys = self._keys[filled:]
            if self.law == "exact":
                done, written = cross(
                    voltage, pending, drift, noise, span_us, above, below, held, near, done, count,
                    key, pixels.start, self.width, sensor.refractory_us, sensor.reset_sigma, times, sizes,
                    offset_us, keys,
                )  # fmt: skip
            else:
                done, written = cross_by_paper(
                    voltage, drift, noise, span_us, above, below, done, key, pixels.start, self.width,
                    offset_us, keys,
                )  # fmt: skip
            filled += written
            if done < count:
                self._keys = np.concatenate([self._keys, np.empty_like(self._keys)])
        return filled


def kick_arrays(band: Band) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A band's kicks as (kicks, rows) times and (kicks,) sizes, in order of time."""
    kicks = sorted(band.kicks, key=lambda kick: float(kick[0][0]))
    rows = band.light.size // band.sensor.width
    times = np.array([times for times, _ in kicks]).reshape(len(kicks), rows)
    return times, np.array([size for _, size in kicks], np.float64)
