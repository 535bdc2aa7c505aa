"""All pixels of a sensor: their state planes, and one step of all of them, band of rows by band of rows."""

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .band_state import BandState
from .band_step import BandStepper
from .effect import Band, Effect, Image, Plane, State, overrides
from .fixed_pattern import FixedPattern, lay_down
from .frames import host_image
from .groups import Motion, Pixels
from .key_order import in_rising_order
from .kicks import no_kicks
from .law import Law
from .limits import Limits
from .parameters import Parameters
from .random import CROSSINGS, START, interval_key
from .several_steps import SeveralSteps
from .stationary import start_voltage
from .still_rows import StillRows
from .workspace import Keys, Workspace

BAND_PIXELS = 49152
"""Few enough for the planes of a band to stay in cache, enough to drown the calls' cost."""


def nothing() -> None:
    """Done meanwhile."""


class PixelArray:
    """State of width x height pixels, and what happens to it from one instant to the next."""

    def __init__(self, width: int, height: int, law: Law, seed: int, threads: int) -> None:
        self.width, self.height, self.seed = width, height, seed
        self.law: Law = law
        pixels = width * height
        self.voltage = np.zeros(pixels, np.float32)
        self._pending = np.zeros(pixels, np.float32)
        self.light, self._response = np.zeros(pixels, np.float32), np.zeros(pixels, np.float32)
        self._held = np.zeros(0, np.float32)  # once there is any dead time
        self.effects: list[Effect] = []
        self._set_us: dict[str, float] = {}
        self.state: dict[str, State] = {}
        shares = threads * math.ceil(pixels / BAND_PIXELS / threads)  # as many bands for each thread
        self._band_rows = math.ceil(height / min(shares, height))
        self._workspaces = [Workspace(self._band_rows * width) for _ in range(threads)]
        self._pool = ThreadPoolExecutor(max(1, threads - 1))  # this thread does its share, too
        self._still = StillRows(width, height, seed, self._pending)
        self._bands: list[BandState] = []
        self._steps, self._elapsed_us = 0, 0.0
        self.limits = Limits()  # of the interval at hand

    def laid_down(self, parameters: Parameters) -> FixedPattern:
        """The fixed pattern for parameters. Touches nothing: it may be made while steps go on."""
        return lay_down(self.width, self.height, self.seed, self.law, parameters, self._set_us)

    def configure(self, pattern: FixedPattern) -> None:
        """Take on parameters and what was laid down for them; the effects that stay on keep their state."""
        self._still.wake_all(self._bands)
        self._pattern, self.sensor = pattern, pattern.sensor
        sensor = self.sensor
        former = {effect.name: effect for effect in self.effects}
        self.effects = pattern.effects
        for effect in self.effects:
            if effect != former.get(effect.name):
                self._set_us[effect.name] = self._elapsed_us
        sensor.theta_on, self._above = self._shared(sensor.theta_on)
        sensor.theta_off, self._below = self._shared(sensor.theta_off)
        keepers = [effect for effect in self.effects if overrides(effect, "state")]
        self.state = {e.name: self.state.get(e.name) or e.state(sensor) for e in keepers}
        self.longest_step_us = pattern.parameters.longest_step_us
        self._still.allowed = self.law == "exact" and all(effect.steady for effect in self.effects)
        if sensor.refractory_us > 0 and self._held.size == 0:
            self._held = np.zeros_like(self.voltage)
        self._stepper = BandStepper(self.law, pattern)
        self._divide()
        at_once = self.law == "exact" and len(self._bands) == 1 and self._stepper.instant
        at_once &= self.longest_step_us == math.inf
        self.most_at_once = BAND_PIXELS // self.voltage.size if at_once else 1
        self._several: SeveralSteps | None = None  # made when it is first needed

    def _divide(self) -> None:
        """Make the bands, over the planes and states as they are now."""
        self._bands = [self._band_state(row) for row in range(0, self.height, self._band_rows)]

    def _shared(self, theta: Plane) -> tuple[Plane, Plane]:
        """Thresholds (height, width), and flat; if all are the same, as one number, and flat for one band."""
        if (theta == theta[0, 0]).all():
            return np.broadcast_to(theta[0, 0], theta.shape), theta[: self._band_rows].flatten()
        return theta, theta.ravel()

    def _band_state(self, first_row: int) -> BandState:
        """The band that starts at a row, in this thread's workspace."""
        workspace = self._workspaces[0]
        end_row = min(first_row + self._band_rows, self.height)
        place = slice(first_row * self.width, end_row * self.width)
        size = place.stop - place.start
        sensor = self.sensor
        light, response, drift, noise, bow, rate = workspace.planes[:, :size]
        band = Band(
            sensor, first_row, 0, 0.0, 0.0, sensor.temperature_c,
            self.light[place], light, response, drift, noise, bow, rate,
            leak=None if sensor.leak is None else sensor.leak.ravel()[place],
            planes={
                name: {k: a[..., place] if is_plane(a, self.voltage) else a for k, a in state.items()}
                for name, state in self.state.items()
            },
        )  # fmt: skip
        pixels = Pixels(
            voltage=self.voltage[place],
            pending=self._pending[place],
            held=self._held[place] if self._held.size else workspace.zeros[:size],
            above=self._above[place] if self._above.size == self.voltage.size else self._above[:size],
            below=self._below[place] if self._below.size == self.voltage.size else self._below[:size],
        )
        return BandState(
            workspace, band, place.start, self.width, pixels, Motion(drift, noise),
            self._still.of_band(slice(first_row, end_row)), self.light[place], self._response[place],
            no_kicks(workspace.zeros[:size]), has_held=self._held.size > 0,
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
        self._divide()

    def image(self, frame: ArrayLike) -> Image:
        """A frame as an own (height, width) array, uint8 or float32. Raises ValueError."""
        return host_image(frame, self.height, self.width)

    def host_image(self, image: Image) -> Image:
        """An own copy of such an array."""
        return image.copy()

    def settle(self, image: Image, t_us: int) -> None:
        """Show an image as if it had been there for long: light and response of that instant, no events."""
        self._still.wake_all(self._bands)
        image = image.ravel()
        for state in self._bands:
            band = self._stepper.see(state, image, t_us, 0.0, self._elapsed_us)
            state.light[:], state.response[:] = band.light, band.response

    def start(self, t_us: int) -> None:
        """Voltages of pixels that have watched the settled image for long; the paper's law starts at 0."""
        if self.law == "paper":
            return
        key = interval_key(self.seed, START, 0)
        for state in self._bands:
            band = state.band
            band.start_us, band.span_us = t_us, 1.0
            band.light[:] = state.light
            self._stepper.add_drift(band)
            start_voltage(state.pixels, state.motion, key, state.first_pixel)

    def forget_events(self) -> None:
        """Empty what effects keep of events on their way: queues, times."""
        for effect in self.effects:
            if overrides(effect, "report") and overrides(effect, "state"):
                self.state[effect.name] = effect.state(self.sensor)

    def look(self, before: Image, after: Image, span_us: float) -> None:
        """Two frames (height, width) whose difference the next steps make, in span_us."""
        if self._still.allowed:
            self._still.look(before, after, span_us)

    def step(
        self, before: Image, after: Image, share: float, start_us: int, offset_us: float, span_us: float,
        meanwhile: Callable[[], None] = nothing,
    ) -> None:  # fmt: skip
        """From the last instant to the next, at which the sensor is that share of the way between two images.

        The step starts offset_us after start_us, from which its events are timed. meanwhile: what this
        thread does before it joins the others.
        """
        self.limits.hurry()
        image = between(before, after, share).ravel()
        key = interval_key(self.seed, CROSSINGS, self._steps)
        waiting = deque(self._bands)

        def work(workspace: Workspace) -> None:
            workspace.most_keys, workspace.limits = self.limits.most_events, self.limits
            while state := _next(waiting):
                state.work_in(workspace)
                self._step(state, image, key, start_us, offset_us, span_us)

        others = [self._pool.submit(work, workspace) for workspace in self._workspaces[1:]]
        try:
            meanwhile()
            work(self._workspaces[0])
        finally:
            if others:  # a small sensor feels a call that waits for nothing
                wait(others)
        for other in others:
            other.result()
        self._still.pass_by(span_us)
        self._steps += 1
        self._elapsed_us += span_us

    def steps_at_once(
        self, images: Sequence[Image], times_us: Sequence[int], t_us: int, start_us: int
    ) -> None:
        """From the last image, at t_us, to these (height, width) at their times, `most_at_once` at most.

        Events are timed from start_us.
        """
        self.limits.hurry()
        self._still.wake_all(self._bands)
        if self._several is None:
            self._several = SeveralSteps(self._pattern, self._stepper, self.most_at_once)
        state, workspace = self._bands[0], self._workspaces[0]
        workspace.most_keys, workspace.limits = self.limits.most_events, self.limits
        spans_us = np.diff(np.array([t_us, *times_us], np.float64))
        self._several.draw(state, images, spans_us, float(t_us - start_us), self.seed, self._steps)
        for span_us in spans_us.tolist():
            self._still.pass_by(span_us)
        self._steps += len(images)
        self._elapsed_us += float(spans_us.sum())

    def _step(
        self, state: BandState, image: Image, key: np.uint64, start_us: int, offset_us: float, span_us: float
    ) -> None:
        """A step of one band."""
        if state.rows_ahead:
            self._still.wake(state)
            self._still.draw_due(state, key, span_us, offset_us)
            if state.rows_ahead == state.rows.ahead.size:
                return
        band = self._stepper.see(state, image, start_us + int(offset_us), span_us, self._elapsed_us)
        self._stepper.add_drift(band)
        self._stepper.draw_events(state, key, offset_us)
        if self._still.allowed:
            self._still.draw_ahead(state, span_us)

    def take_keys(self) -> Keys:
        """The event keys of the steps since the last call. Raises TooManyEventsError."""
        taken = [workspace.take_keys() for workspace in self._workspaces]
        self.limits.admit(sum(map(len, taken)))
        return taken[0] if len(taken) == 1 else np.concatenate(taken)

    def host_keys(self, keys: Keys) -> Keys:
        """Keys on the host."""
        return keys

    def in_order(self, keys: Keys, span_us: int) -> Keys:
        """Keys of an interval of span_us, sorted."""
        return in_rising_order(keys)

    def abandon(self) -> None:
        """Leave the interval under way: its events are forgotten, each voltage is what it has come to."""
        for workspace in self._workspaces:
            workspace.forget_keys()
        self._still.forget(self._bands)
        self._steps += 1

    @property
    def state_bytes(self) -> int:
        """Memory of all planes, without the events of an interval."""
        own = [self.voltage, self._pending, self.light, self._response, self._held]
        own += [self._above, self._below]
        own += [array for state in self.state.values() for array in state.values()]
        scratch = sum(workspace.nbytes for workspace in self._workspaces)
        scratch += self._several.nbytes if self._several else 0
        return sum(array.nbytes for array in own) + self._still.nbytes + scratch

    @property
    def event_bytes(self) -> int:
        """Memory of the space for the events of an interval."""
        return sum(workspace.event_bytes for workspace in self._workspaces)


def _next(waiting: deque[BandState]) -> BandState | None:
    """The next band that no thread has taken."""
    try:
        return waiting.popleft()
    except IndexError:
        return None


def between(before: Image, after: Image, share: float) -> Image:
    """What is that share of the way between two images."""
    if share >= 1:
        return after
    part = np.float32(share)
    return ((1 - part) * before + part * after).astype(np.float32, copy=False)


def is_plane(array: NDArray[np.generic], voltage: Plane) -> bool:
    """True for a state that has a number, or several, for each pixel."""
    return array.dtype == np.float32 and array.shape[-1:] == voltage.shape
