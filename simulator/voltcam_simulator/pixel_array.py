"""All pixels of a sensor: their state planes, and one step of all of them, band of rows by band of rows."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .effect import Band, Effect, Plane, Sensor, State, overrides
from .paper_law import cross_by_paper
from .parameters import Parameters
from .pixel import cross, gather, take_over
from .random import CROSSINGS, START, interval_key
from .stationary import start_voltage

Law = Literal["exact", "paper"]
Keys = NDArray[np.uint64]
Image = NDArray[np.uint8] | Plane

BAND_PIXELS = 32768  # few enough for the planes of a band to stay in cache, enough to drown the calls' cost


@dataclass
class _Rows:
    """A band and the sensor's own planes at its place."""

    band: Band
    pixels: slice
    voltage: Plane
    pending: Plane
    light: Plane
    response: Plane
    held: Plane
    above: Plane
    below: Plane


class PixelArray:
    """State of width x height pixels, and what happens to it from one instant to the next."""

    def __init__(self, width: int, height: int, law: Law, seed: int) -> None:
        self.width, self.height, self.law, self.seed = width, height, law, seed
        pixels = width * height
        self.voltage = np.zeros(pixels, np.float32)
        self._pending = np.zeros(pixels, np.float32)  # variance gathered since a voltage was last drawn
        self._light, self._response = np.zeros(pixels, np.float32), np.zeros(pixels, np.float32)
        self._held = np.zeros(0, np.float32)  # dead time left [us], once there is any
        self.state: dict[str, State] = {}
        self._band_rows = max(1, min(BAND_PIXELS // width, height))
        band_pixels = self._band_rows * width
        self._scratch = np.empty((4, band_pixels), np.float32)
        self._free = np.zeros(band_pixels, np.float32)
        self._near = np.empty(band_pixels + 1, np.int32)
        self._keys = np.empty(8192, np.uint64)
        self._steps, self._elapsed_us = 0, 0.0

    def configure(self, parameters: Parameters) -> None:
        """Take on parameters: lay down the fixed pattern, keep the state of the effects that stay on."""
        theta_on, theta_off = np.ones((2, self.height, self.width), np.float32)
        dark_level_dn = parameters.contrast_response.k2_dn
        self.sensor = sensor = Sensor(
            self.width, self.height, self.seed, parameters.temperature_c, dark_level_dn, theta_on, theta_off
        )
        self.effects = [self._by_law(effect) for effect in parameters.effects() if effect.active]
        for effect in self.effects:
            effect.prepare(sensor)
        keepers = [effect for effect in self.effects if overrides(effect, "state")]
        self.state = {e.name: self.state.get(e.name) or e.state(sensor) for e in keepers}
        self._see, self._respond, self._drift = (
            [effect for effect in self.effects if overrides(effect, stage)]
            for stage in ("see", "respond", "drift")
        )
        self.longest_step_us = min(effect.longest_step_us for effect in self.effects)
        if sensor.refractory_us > 0 and self._held.size == 0:
            self._held = np.zeros_like(self.voltage)
        self._bands = [self._rows(row) for row in range(0, self.height, self._band_rows)]

    def _by_law(self, effect: Effect) -> Effect:
        """The paper's law is defined with the linearised response."""
        if self.law == "paper" and effect.name == "contrast_response":
            return effect.model_copy(update={"response": "linearised"})
        return effect

    def _rows(self, first_row: int) -> _Rows:
        """The band that starts at a row."""
        end_row = min(first_row + self._band_rows, self.height)
        pixels = slice(first_row * self.width, end_row * self.width)
        size = pixels.stop - pixels.start
        sensor = self.sensor
        light, response, drift, noise = self._scratch[:, :size]
        band = Band(
            sensor, first_row, 0, 0.0, 0.0, sensor.temperature_c,
            self._light[pixels], light, response, drift, noise,
            leak=None if sensor.leak is None else sensor.leak.ravel()[pixels],
            planes={
                name: {key: array[pixels] for key, array in state.items() if array.size == self.voltage.size}
                for name, state in self.state.items()
            },
        )  # fmt: skip
        held = self._held[pixels] if self._held.size else self._free[:size]
        return _Rows(
            band, pixels, self.voltage[pixels], self._pending[pixels], self._light[pixels],
            self._response[pixels], held, sensor.theta_on.ravel()[pixels], sensor.theta_off.ravel()[pixels],
        )  # fmt: skip

    def settle(self, image: Image, t_us: int) -> None:
        """Show an image as if it had been there for long: light and response of that instant, no events."""
        for rows in self._bands:
            band = self._seen(rows, image, t_us, 0.0)
            rows.light[:], rows.response[:] = band.light, band.response

    def start(self, t_us: int) -> None:
        """Voltages of pixels that have watched the settled image for long; the paper's law starts at 0."""
        if self.law == "paper":
            return
        key = interval_key(self.seed, START, 0)
        for rows in self._bands:
            band = rows.band
            band.start_us, band.span_us = t_us, 1.0
            band.light[:] = rows.light
            self._add_drift(band)
            start_voltage(
                rows.voltage, band.drift, band.noise, rows.above, rows.below, key, rows.pixels.start
            )

    def step(self, image: Image, start_us: int, offset_us: float, span_us: float, filled: int) -> int:
        """From the last instant to the next, at which the sensor sees `image` (pixels,) DN.

        The step starts offset_us after start_us. Keys of its events, timed from start_us, go behind the
        `filled` first of `keys`; returns the new number.
        """
        key = interval_key(self.seed, CROSSINGS, self._steps)
        for rows in self._bands:
            band = self._seen(rows, image, start_us + int(offset_us), span_us)
            self._add_drift(band)
            take_over(band.light, band.response, band.drift, rows.light, rows.response)
            filled = self._events(rows, key, offset_us, filled)
        self._steps += 1
        self._elapsed_us += span_us
        return filled

    def keys(self, filled: int) -> Keys:
        """The first `filled` event keys."""
        return self._keys[:filled]

    def _seen(self, rows: _Rows, image: Image, start_us: int, span_us: float) -> Band:
        """A band at the end of a step: light and response there."""
        band = rows.band
        band.start_us, band.span_us, band.elapsed_us = start_us, span_us, self._elapsed_us
        band.light[:] = image[rows.pixels]
        band.response.fill(0)
        for effect in self._see:
            effect.see(band)
        for effect in self._respond:
            effect.respond(band)
        return band

    def _add_drift(self, band: Band) -> None:
        """Drift and noise of a step, of all effects but the response."""
        band.temperature_c, band.noise2, band.kicks = self.sensor.temperature_c, None, []
        band.drift.fill(0)
        band.noise.fill(0)
        for effect in self._drift:
            effect.drift(band)
        if band.noise2 is not None:
            np.sqrt(band.noise * band.noise + band.noise2, out=band.noise)

    def _events(self, rows: _Rows, key: np.uint64, offset_us: float, filled: int) -> int:
        """Follow a band's voltages over the step; its event keys go behind the `filled` first."""
        band, sensor = rows.band, self.sensor
        voltage, above, below, held, near = rows.voltage, rows.above, rows.below, rows.held, self._near
        drift, noise, span_us = band.drift, band.noise, band.span_us
        done, count = 0, voltage.size
        if self.law == "exact":
            times, sizes = kick_arrays(band)
            slack = np.float32(np.abs(sizes).sum())
            count = gather(
                voltage, rows.pending, drift, noise, np.float32(span_us), above, below, held, slack, near
            )
        while done < count:
            keys = self._keys[filled:]
            if self.law == "exact":
                done, written = cross(
                    voltage, rows.pending, drift, noise, span_us, above, below, held, near, done, count,
                    key, rows.pixels.start, self.width, sensor.refractory_us, sensor.reset_sigma, times, sizes,
                    offset_us, keys,
                )  # fmt: skip
            else:
                done, written = cross_by_paper(
                    voltage, drift, noise, span_us, above, below, done, key, rows.pixels.start, self.width,
                    offset_us, keys,
                )  # fmt: skip
            filled += written
            if done < count:
                self._keys = np.concatenate([self._keys, np.empty_like(self._keys)])
        return filled


_NO_KICKS = np.empty((0, 1)), np.empty(0)


def kick_arrays(band: Band) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A band's kicks as (kicks, rows) times and (kicks,) sizes, in order of time."""
    if not band.kicks:
        return _NO_KICKS
    kicks = sorted(band.kicks, key=lambda kick: float(kick[0][0]))
    return np.array([times for times, _ in kicks]), np.array([size for _, size in kicks], np.float64)
