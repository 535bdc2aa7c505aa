"""The simulator: frames one by one in, time-sorted events out, every pixel's voltage kept between them."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .cameras import SIDE_LIMIT
from .effect import EVENT, Effect, Interval, Plane, Sensor
from .first_passage import TIME_BITS, cross, gather, start_voltage, unpack
from .paper_law import cross_by_paper
from .parameters import Parameters
from .random import CROSSINGS, START, interval_key

Law = Literal["exact", "paper"]

BAND_PIXELS = 16384  # the planes of a band stay in the processor's cache from effect to effect
LONGEST_INTERVAL_US = 2**TIME_BITS - 1


class Simulator:
    """A sensor of width x height pixels, by `law` "exact" (Brownian motion itself) or "paper".

    The same seed gives the same events. `parameters` may be assigned between two frames and hold for all
    that follows; voltages are kept.
    """

    def __init__(
        self, width: int, height: int, parameters: Parameters | None = None, law: Law = "exact", seed: int = 0
    ) -> None:
        if not (1 <= width <= SIDE_LIMIT and 1 <= height <= SIDE_LIMIT):
            raise ValueError(
                f"a sensor of {width} x {height} is not possible: sides go from 1 to {SIDE_LIMIT}"
            )
        if law not in ("exact", "paper"):
            raise ValueError(f"unknown law {law!r}: give 'exact' or 'paper'")
        if not 0 <= seed < 2**63:
            raise ValueError(f"seed {seed} is out of range: give 0 to 2^63 - 1")
        self.width, self.height, self.law, self.seed = width, height, law, seed
        pixels = width * height
        self._voltage = np.zeros(pixels, np.float32)
        self._pending = np.zeros(pixels, np.float32)  # variance gathered since a voltage was last drawn
        self._frame: Plane | None = None
        self._t_us = 0
        self._intervals = 0
        self._drift, self._noise = np.empty(BAND_PIXELS, np.float32), np.empty(BAND_PIXELS, np.float32)
        self._near = np.empty(BAND_PIXELS + 1, np.int32)
        self._keys = np.empty(BAND_PIXELS, np.uint64)
        self.parameters = parameters if parameters is not None else Parameters()

    @property
    def parameters(self) -> Parameters:
        """What the sensor is set to."""
        return self._parameters

    @parameters.setter
    def parameters(self, parameters: Parameters) -> None:
        theta_on, theta_off = np.ones((2, self.height, self.width), np.float32)
        sensor = Sensor(self.width, self.height, self.seed, theta_on, theta_off)
        effects = [self._by_law(effect) for effect in parameters.effects() if effect.active]
        for effect in effects:
            effect.prepare(sensor)
        self._effects = effects
        self._above, self._below = sensor.theta_on.ravel(), sensor.theta_off.ravel()
        self._parameters = parameters

    def _by_law(self, effect: Effect) -> Effect:
        """The paper's law is defined with the linearised response."""
        if self.law == "paper" and effect.name == "contrast_response":
            return effect.model_copy(update={"response": "linearised"})
        return effect

    def advance(self, frame: ArrayLike, t_us: int) -> NDArray[np.void]:
        """The events between the last frame and this one, sorted by time.

        frame: (height, width) grey levels, 0..255 DN unless the parameters say otherwise; any real dtype.
        t_us: its time, int microseconds, later than the last one. The first frame gives no events.
        Returns an array of dtype EVENT. Raises ValueError, with nothing changed, for a wrong shape, values
        that are negative or not finite, or a time that does not advance.
        """
        plane = self._checked(frame)
        if self._frame is None:
            self._begin(plane, t_us)
            return np.empty(0, EVENT)
        span_us = t_us - self._t_us
        if span_us <= 0:
            raise ValueError(f"the frame at {t_us} us does not come after the last one at {self._t_us} us")
        if span_us > LONGEST_INTERVAL_US:
            raise ValueError(f"{span_us / 3.6e9:.0f} hours between two frames: at most 38 are possible")
        filled = 0
        for start in range(0, plane.size, BAND_PIXELS):
            filled = self._advance_band(self._frame, plane, start, float(span_us), filled)
        events = self._sorted_events(filled)
        self._frame, self._t_us = plane, t_us
        self._intervals += 1
        return events

    def jump(self, frame: ArrayLike, t_us: int) -> None:
        """Go on from another frame and time, earlier or later, with no events for the change."""
        plane = self._checked(frame)
        if self._frame is None:
            self._begin(plane, t_us)
        self._frame, self._t_us = plane, t_us

    def _begin(self, plane: Plane, t_us: int) -> None:
        """Pixels that have watched the first frame for long; the paper's law starts all at 0."""
        self._frame, self._t_us = plane, t_us
        if self.law == "paper":
            return
        key = interval_key(self.seed, START, 0)
        for start in range(0, plane.size, BAND_PIXELS):
            band = slice(start, min(start + BAND_PIXELS, plane.size))
            still = self._interval(plane[band], plane[band], 1.0)
            start_voltage(
                self._voltage[band],
                still.drift,
                still.noise,
                self._above[band],
                self._below[band],
                key,
                start,
            )

    def _interval(self, first: Plane, last: Plane, span_us: float) -> Interval:
        """Drift and noise of a band of pixels, all effects added."""
        drift, noise = self._drift[: first.size], self._noise[: first.size]
        drift.fill(0)
        noise.fill(0)
        parameters = self._parameters
        interval = Interval(
            span_us, parameters.temperature_c, parameters.contrast_response.k2_dn, first, last, drift, noise
        )
        for effect in self._effects:
            effect.apply(interval)
        return interval

    def _advance_band(self, first: Plane, last: Plane, start: int, span_us: float, filled: int) -> int:
        """One band over one interval; its event keys go behind the `filled` first. Returns the new number."""
        band = slice(start, min(start + BAND_PIXELS, first.size))
        interval = self._interval(first[band], last[band], span_us)
        voltage, pending = self._voltage[band], self._pending[band]
        above, below = self._above[band], self._below[band]
        drift, noise = interval.drift, interval.noise
        done, count = 0, voltage.size
        if self.law == "exact":
            span = np.float32(span_us)
            count = gather(voltage, pending, drift, noise, span, above, below, self._near)
        key = interval_key(self.seed, CROSSINGS, self._intervals)
        while done < count:
            at = (key, start, self.width, self._keys[filled:])
            if self.law == "exact":
                done, written = cross(
                    voltage, pending, drift, noise, span_us, above, below, self._near, done, count, *at
                )
            else:
                done, written = cross_by_paper(voltage, drift, noise, span_us, above, below, done, *at)
            filled += written
            if done < count:
                self._keys = np.concatenate([self._keys, np.empty_like(self._keys)])
        return filled

    def _sorted_events(self, filled: int) -> NDArray[np.void]:
        keys = self._keys[:filled]
        keys.sort()
        events = np.empty(filled, EVENT)
        unpack(keys, self._t_us, events["t"], events["x"], events["y"], events["p"])
        return events

    def _checked(self, frame: ArrayLike) -> Plane:
        """The frame as a new flat float32 plane."""
        image = np.asarray(frame)
        if image.shape != (self.height, self.width):
            raise ValueError(
                f"the frame is {image.shape}, the sensor (height, width) = {(self.height, self.width)}"
            )
        if image.dtype == np.uint8:
            return image.astype(np.float32).ravel()
        if image.dtype.kind not in "buif":
            raise ValueError(f"the frame is of type {image.dtype}: give real numbers")
        plane = image.astype(np.float32).ravel()
        if not (np.isfinite(plane).all() and plane.min() >= 0):
            raise ValueError("the frame has values that are negative or not finite: grey levels start at 0")
        return plane
