"""All pixels of a sensor: their state planes, and one step of all of them, band of rows by band of rows."""

import math
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .band_state import Image, Keys, Room, Rows, kick_arrays
from .crossings import cross
from .effect import Band, Effect, Plane, Sensor, State, overrides
from .limits import Limits
from .out_of_reach import gather, take_over
from .paper_law import cross_by_paper
from .parameters import Parameters
from .random import CROSSINGS, START, interval_key
from .stationary import start_voltage
from .still_rows import StillRows

Law = Literal["exact", "paper"]

BAND_PIXELS = 49152  # few enough for the planes of a band to stay in cache, enough to drown the calls' cost


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Parameters, the effects that are on, and the fixed pattern that these have laid down on the sensor."""

    parameters: Parameters
    effects: list[Effect]
    sensor: Sensor


class PixelArray:
    """State of width x height pixels, and what happens to it from one instant to the next."""

    def __init__(self, width: int, height: int, law: Law, seed: int, threads: int) -> None:
        self.width, self.height, self.law, self.seed = width, height, law, seed
        pixels = width * height
        self.voltage = np.zeros(pixels, np.float32)
        self._pending = np.zeros(pixels, np.float32)  # variance gathered since a voltage was last drawn
        self.light, self._response = np.zeros(pixels, np.float32), np.zeros(pixels, np.float32)
        self._held = np.zeros(0, np.float32)  # dead time left [us], once there is any
        self.effects: list[Effect] = []
        self._set_us: dict[str, float] = {}
        self.state: dict[str, State] = {}
        shares = threads * math.ceil(pixels / BAND_PIXELS / threads)  # as many bands for each thread
        self._band_rows = math.ceil(height / min(shares, height))
        self._rooms = [Room(self._band_rows * width) for _ in range(threads)]
        self._pool = ThreadPoolExecutor(max(1, threads - 1))  # this thread does its share, too
        self._still = StillRows(width, height, seed, since=self._pending)
        self._bands: list[Rows] = []
        self._steps, self._elapsed_us = 0, 0.0
        self.limits = Limits()  # of the interval at hand

    def laid_down(self, parameters: Parameters) -> Pattern:
        """The fixed pattern for parameters. Touches nothing: it may be made while steps go on."""
        theta_on, theta_off = np.ones((2, self.height, self.width), np.float32)
        dark_level_dn = parameters.contrast_response.k2_dn
        sensor = Sensor(
            self.width, self.height, self.seed, parameters.temperature_c, dark_level_dn, theta_on, theta_off,
            set_us=self._set_us,
        )  # fmt: skip
        effects = [self._by_law(effect) for effect in parameters.effects() if effect.active]
        for effect in effects:
            effect.prepare(sensor)
        return Pattern(parameters, effects, sensor)

    def configure(self, pattern: Pattern) -> None:
        """Take on parameters and what was laid down for them; the effects that stay on keep their state."""
        self._still.wake_all(self._bands)
        self.sensor = sensor = pattern.sensor
        former = {effect.name: effect for effect in self.effects}
        self.effects = pattern.effects
        for effect in self.effects:
            if effect != former.get(effect.name):
                self._set_us[effect.name] = self._elapsed_us
        sensor.theta_on, self._above = self._shared(sensor.theta_on)
        sensor.theta_off, self._below = self._shared(sensor.theta_off)
        keepers = [effect for effect in self.effects if overrides(effect, "state")]
        self.state = {e.name: self.state.get(e.name) or e.state(sensor) for e in keepers}
        self._see, self._respond, self._drift = (
            [effect for effect in self.effects if overrides(effect, stage)]
            for stage in ("see", "respond", "drift")
        )
        self.longest_step_us = pattern.parameters.longest_step_us
        self._still.allowed = self.law == "exact" and all(effect.steady for effect in self.effects)
        if sensor.refractory_us > 0 and self._held.size == 0:
            self._held = np.zeros_like(self.voltage)
        self._bands = self._divided()

    def _divided(self) -> list[Rows]:
        """The bands, over the planes and states as they are now."""
        starts = range(0, self.height, self._band_rows)
        return [self._rows(row, self._rooms[i % len(self._rooms)]) for i, row in enumerate(starts)]

    def _shared(self, theta: Plane) -> tuple[Plane, Plane]:
        """Thresholds (height, width), and flat; if all are the same, as one number, and flat for one band."""
        if (theta == theta[0, 0]).all():
            return np.broadcast_to(theta[0, 0], theta.shape), theta[: self._band_rows].flatten()
        return theta, theta.ravel()

    def _by_law(self, effect: Effect) -> Effect:
        """The paper's law is defined with the linearised response."""
        if self.law == "paper" and effect.name == "contrast_response":
            return effect.model_copy(update={"response": "linearised"})
        return effect

    def _rows(self, first_row: int, room: Room) -> Rows:
        """The band that starts at a row, in a thread's room."""
        end_row = min(first_row + self._band_rows, self.height)
        lines = slice(first_row, end_row)
        pixels = slice(first_row * self.width, end_row * self.width)
        size = pixels.stop - pixels.start
        sensor = self.sensor
        light, response, drift, noise = room.planes[:, :size]
        band = Band(
            sensor, first_row, 0, 0.0, 0.0, sensor.temperature_c,
            self.light[pixels], light, response, drift, noise,
            leak=None if sensor.leak is None else sensor.leak.ravel()[pixels],
            planes={
                name: {k: a[pixels] if is_plane(a, self.voltage) else a for k, a in state.items()}
                for name, state in self.state.items()
            },
        )  # fmt: skip
        above, below = (
            plane[pixels] if plane.size == self.voltage.size else plane[:size]
            for plane in (self._above, self._below)
        )
        still = self._still
        held = self._held[pixels] if self._held.size else room.zeros[:size]
        return Rows(
            room, band, pixels, self.voltage[pixels], self._pending[pixels], self.light[pixels],
            self._response[pixels], held, above, below,
            still.quiet[lines], still.ahead[lines], still.begun[lines], still.due[pixels],
            still.motion[pixels],
        )  # fmt: skip

    def snapshot(self) -> dict[str, NDArray[np.generic]]:
        """Copies of all that further steps depend on, but for the parameters; rows ahead are brought back."""
        self._still.wake_all(self._bands)
        set_us = [self._set_us.get(effect.name, 0.0) for effect in self.effects]
        return {
            "voltage": self.voltage.copy(),
            "pending": self._pending.copy(),
            "light": self.light.copy(),
            "response": self._response.copy(),
            "held": self._held.copy(),
            "counts": np.array([self._steps, self._still.steps], np.int64),
            "clocks_us": np.array([self._elapsed_us, self._still.now_us, *set_us]),
            **{
                f"state/{effect}/{name}": array.copy()
                for effect, state in self.state.items()
                for name, array in state.items()
            },
        }

    def restore(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Be as when `snapshot` was taken of a sensor of this size, seed, law and parameters."""
        self._held = np.array(saved["held"], np.float32)
        for name, plane in (
            ("voltage", self.voltage),
            ("pending", self._pending),
            ("light", self.light),
            ("response", self._response),
        ):
            plane[:] = saved[name]
        steps, still_steps = saved["counts"].tolist()
        self._elapsed_us, now_us, *set_us = saved["clocks_us"].tolist()
        self._steps = steps
        self._still.restore(still_steps, now_us)
        self._set_us.update(zip((effect.name for effect in self.effects), set_us, strict=True))
        for effect, state in self.state.items():
            state.update({name: np.array(saved[f"state/{effect}/{name}"]) for name in state})
        self._bands = self._divided()

    def settle(self, image: Image, t_us: int) -> None:
        """Show an image as if it had been there for long: light and response of that instant, no events."""
        self._still.wake_all(self._bands)
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

    def forget_events(self) -> None:
        """Empty what effects keep of events on their way: queues, times."""
        for effect in self.effects:
            if overrides(effect, "report") and overrides(effect, "state"):
                self.state[effect.name] = effect.state(self.sensor)

    def look(self, before: Image, after: Image, span_us: float) -> None:
        """Two frames (height, width) whose difference the next steps make, in span_us."""
        if self._still.allowed:
            self._still.look(before, after, span_us)

    def step(self, image: Image, start_us: int, offset_us: float, span_us: float) -> None:
        """From the last instant to the next, at which the sensor sees `image` (pixels,) DN.

        The step starts offset_us after start_us, from which its events are timed.
        """
        self.limits.hurry()
        key = interval_key(self.seed, CROSSINGS, self._steps)

        def share(room: Room) -> None:
            for rows in self._bands:
                if rows.room is room:
                    self._step(rows, image, key, start_us, offset_us, span_us)

        for room in self._rooms:
            room.most_keys, room.limits = self.limits.most_events // len(self._rooms), self.limits
        others = [self._pool.submit(share, room) for room in self._rooms[1:]]
        try:
            share(self._rooms[0])
        finally:
            wait(others)
        for other in others:
            other.result()
        self._still.pass_by(span_us)
        self._steps += 1
        self._elapsed_us += span_us

    def _step(
        self, rows: Rows, image: Image, key: np.uint64, start_us: int, offset_us: float, span_us: float
    ) -> None:
        """A step of one band."""
        if rows.rows_ahead:
            self._still.wake(rows)
            self._still.draw_due(rows, key, span_us, offset_us)
            if rows.rows_ahead == rows.ahead.size:
                return
        band = self._seen(rows, image, start_us + int(offset_us), span_us)
        self._add_drift(band)
        take_over(band.light, band.response, band.drift, rows.light, rows.response)
        self._draw_events(rows, key, offset_us)
        if self._still.allowed:
            self._still.draw_ahead(rows, span_us)

    def take_keys(self) -> Keys:
        """The event keys of the steps since the last call."""
        taken = [room.take_keys() for room in self._rooms]
        return taken[0] if len(taken) == 1 else np.concatenate(taken)

    def abandon(self) -> None:
        """Leave the interval under way: its events are forgotten, each voltage is what it has come to."""
        for room in self._rooms:
            room.forget_keys()
        self._still.forget(self._bands)
        self._steps += 1

    @property
    def state_bytes(self) -> int:
        """Memory of all planes, without the events of an interval."""
        own = [self.voltage, self._pending, self.light, self._response, self._held]
        own += [self._above, self._below]
        own += [array for state in self.state.values() for array in state.values()]
        rooms = sum(room.nbytes for room in self._rooms)
        return sum(array.nbytes for array in own) + self._still.nbytes + rooms

    @property
    def event_bytes(self) -> int:
        """Memory of the space for the events of an interval."""
        return sum(room.event_bytes for room in self._rooms)

    def _seen(self, rows: Rows, image: Image, start_us: int, span_us: float) -> Band:
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

    def _draw_events(self, rows: Rows, key: np.uint64, offset_us: float) -> None:
        """Follow a band's voltages over the step; its event keys go into its room."""
        band, sensor, room = rows.band, self.sensor, rows.room
        voltage, above, below, drift, noise = rows.voltage, rows.above, rows.below, band.drift, band.noise
        span_us, pixel0 = band.span_us, rows.pixels.start
        if self.law == "paper":
            room.draw(voltage.size, lambda done, keys: cross_by_paper(
                voltage, drift, noise, span_us, above, below, done, key, pixel0, self.width, offset_us, keys,
            ))  # fmt: skip
            return
        times, sizes, row_slack = kick_arrays(band)
        slack, reach_above, reach_below = room.zeros[: voltage.size], above, below
        if len(sizes):
            by_row = drift.reshape(-1, self.width)
            by_row += sizes.sum(axis=0)[:, None]
            slack = np.repeat(row_slack, self.width)
            reach_above, reach_below = above - slack, below - slack
        pending, held, near = rows.pending, rows.held, room.near
        careful = self._held.size > 0 or len(times) > 0
        count = gather(
            rows.ahead,
            voltage,
            pending,
            drift,
            noise,
            np.float32(span_us),
            reach_above,
            reach_below,
            held,
            near,
        )
        room.draw(count, lambda done, keys: cross(
            voltage, pending, drift, noise, span_us, above, below, held, slack, careful, near, done, count,
            key, pixel0, self.width, sensor.refractory_us, sensor.reset_sigma, times, sizes, offset_us, keys,
        ))  # fmt: skip


def is_plane(array: NDArray[np.generic], voltage: Plane) -> bool:
    """True for a state that has a number for each pixel."""
    return array.dtype == np.float32 and array.shape == voltage.shape
