"""All pixels of a sensor on a GPU: their state stays there from frame to frame."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..effect import Effect, Plane, State, overrides
from ..event_key import key_bits
from ..fixed_pattern import FixedPattern, lay_down
from ..groups import Kicks, Pixels, Reset, Step
from ..kicks import kicks_of_rows
from ..law import Law
from ..limits import Limits, TooManyEventsError
from ..parameters import Parameters
from ..pixel_array import is_plane, nothing
from ..random import CROSSINGS, START, interval_key
from . import arrays, frames, kernels, traced_band
from .arrays import DeviceArray
from .kernels import CLAIMED, LATE, UNCLAIMED, Frames, Given, Late, Output, Seen
from .program import calls_of, effects_of
from .traced_band import TracedBand, named

FIRST_KEYS = 65536
"""Space for events before any has come, or one for each pixel, if that is more."""
FIRST_ROOM, ROOM_KEYS = 256, 1 << 20
"""Events that a late pixel has space for at first, and all that go together."""
NOTHING = np.iinfo(np.int64).max


class CudaPixels:
    """State of width x height pixels on the device, and what happens to it: as `PixelArray`.

    Raises NoDeviceError where there is no device.
    """

    def __init__(self, width: int, height: int, law: Law, seed: int) -> None:
        arrays.require()
        self.width, self.height, self.seed = width, height, seed
        self.law: Law = law
        pixels = self._pixels = width * height
        voltage, pending, held, above, below = (arrays.zeros(pixels, np.float32) for _ in range(5))
        self._state = Pixels(voltage, pending, held, above, below)
        light, response = (arrays.zeros(pixels, np.float32) for _ in range(2))
        self._seen = Seen(light, response, arrays.zeros(1, np.float32))
        times, sizes = (arrays.zeros((0, height), np.float64) for _ in range(2))
        self._no_kicks = Kicks(times, sizes, arrays.zeros(height, np.float32))
        self._has_held = False
        self._voltage: Plane | None = None  # while the events' effects may change it on the host
        self.effects: list[Effect] = []
        self.state: dict[str, State] = {}
        self._planes: list[DeviceArray] = []
        self._output = self._fresh_output(max(FIRST_KEYS, pixels))
        self._written = 0
        self._set_us: dict[str, float] = {}
        self._steps, self._elapsed_us = 0, 0.0
        self.limits = Limits()  # of the interval at hand

    def laid_down(self, parameters: Parameters) -> FixedPattern:
        """The fixed pattern for parameters. Touches nothing: it may be made while steps go on."""
        return lay_down(self.width, self.height, self.seed, self.law, parameters, self._set_us)

    def configure(self, pattern: FixedPattern) -> None:
        """Take on parameters and what was laid down for them; the effects that stay on keep their state."""
        self.sensor = sensor = pattern.sensor
        former = {effect.name: effect for effect in self.effects}
        self.effects = pattern.effects
        for effect in self.effects:
            if effect != former.get(effect.name):
                self._set_us[effect.name] = self._elapsed_us
        arrays.fill(self._state.above, sensor.theta_on.ravel())
        arrays.fill(self._state.below, sensor.theta_off.ravel())
        leak = np.ones(1, np.float32) if sensor.leak is None else sensor.leak.ravel()
        self._seen = self._seen._replace(leak=arrays.upload(leak))
        keepers = [effect for effect in self.effects if overrides(effect, "state")]
        self.state = {e.name: self.state.get(e.name) or self._taken(e.state(sensor)) for e in keepers}
        self.longest_step_us = pattern.parameters.longest_step_us
        self._has_held |= sensor.refractory_us > 0
        self._reset = Reset(float(sensor.refractory_us), float(sensor.reset_sigma))

    def _taken(self, state: State) -> State:
        """A state, its planes on the device."""
        plane = np.empty(self._pixels, np.float32)
        return {k: arrays.upload(a) if is_plane(a, plane) else a for k, a in state.items()}

    def image(self, frame: ArrayLike) -> DeviceArray:
        """A frame as an own array on the device. Raises ValueError."""
        return frames.device_image(frame, self.height, self.width)

    def host_image(self, image: DeviceArray) -> NDArray[Any]:
        """The same (height, width) on the host."""
        return arrays.download(image).reshape(self.height, self.width)

    def settle(self, image: DeviceArray, t_us: int) -> None:
        """Show an image as if it had been there for long: light and response of that instant, no events."""
        band, planes = self._traced(t_us, 0.0)
        traced_band.see(band, self.effects)
        kernel = kernels.settling(effects_of(calls_of(band)))
        given = self._given(band, planes)
        still = Frames(image, image, np.float32(1))
        arrays.launch(kernel, self._pixels, self._seen, still, given, self.width)

    def start(self, t_us: int) -> None:
        """Voltages of pixels that have watched the settled image for long; the paper's law starts at 0."""
        if self.law == "paper":
            return
        band, planes = self._traced(t_us, 1.0)
        traced_band.add_drift(band, self.effects)
        kernel = kernels.starting(effects_of(calls_of(band)))
        given = self._given(band, planes)
        key = interval_key(self.seed, START, 0)
        arrays.launch(kernel, self._pixels, self._state, self._seen, given, key, self.width)

    def forget_events(self) -> None:
        """Empty what effects keep of events on their way: queues, times."""
        for effect in self.effects:
            if overrides(effect, "report") and overrides(effect, "state"):
                self.state[effect.name] = effect.state(self.sensor)

    def look(self, before: DeviceArray, after: DeviceArray, span_us: float) -> None:
        """Nothing: a thread is quicker to follow its pixel than to find out that it may be drawn ahead."""

    def step(
        self, before: DeviceArray, after: DeviceArray, share: float, start_us: int, offset_us: float,
        span_us: float, meanwhile: Callable[[], None] = nothing,
    ) -> None:  # fmt: skip
        """From the last instant to the next, at which the sensor is that share of the way between two images.

        The step starts offset_us after start_us, from which its events are timed. meanwhile: what is to be
        done on the host.
        """
        self.limits.hurry()
        meanwhile()
        self._take_back_voltage()
        band, planes = self._traced(start_us + int(offset_us), span_us)
        traced_band.see(band, self.effects)
        traced_band.add_drift(band, self.effects)
        key = interval_key(self.seed, CROSSINGS, self._steps)
        step = Step(key, float(span_us), float(offset_us), 0, self.width)
        kicks = self._kicks(band)
        after_it = self._reset, kicks, self._has_held or bool(band.kicks)
        kernel = kernels.stepping(effects_of(calls_of(band)), self.law)
        way = Frames(before, after, np.float32(share))
        given = self._given(band, planes)
        arrays.launch(
            kernel, self._pixels, self._state, self._seen, way, given, step, *after_it, self._output
        )
        self._follow_late(step, after_it)
        self._steps += 1
        self._elapsed_us += span_us

    def _follow_late(self, step: Step, after_it: tuple[Any, ...]) -> None:
        """Follow the pixels whose events did not fit, until all have found room. Raises GivenUpError."""
        room, late = FIRST_ROOM, self._counted()
        while late:
            self.limits.hurry()
            former = self._output
            self._output = former._replace(
                numbers=arrays.empty(self._pixels, np.int32),
                motion=arrays.empty((4, self._pixels), np.float32),
            )
            threads = max(1, min(late, ROOM_KEYS // room))
            space = arrays.empty((threads, room), np.uint64)
            for first in range(0, late, threads):
                turn = Late(former.numbers, former.motion, first, late, space)
                given = self._state, self._seen, step, *after_it, turn, self._output
                arrays.launch(kernels.stepping_late(self.law), threads, *given)
            late, room = self._counted(), room * 8

    def _counted(self) -> int:
        """Read what the device has counted: keys written; where they did not fit, there will be more space.
        Returns how many pixels are late."""
        counts = arrays.download(self._output.counts)
        claimed, late = int(counts[CLAIMED]), int(counts[LATE])
        self._written = min(claimed, int(counts[UNCLAIMED]))
        if late:
            if claimed > self._written:
                self._grow(claimed)
            arrays.fill(self._output.counts, np.array([self._written, NOTHING, 0], np.int64))
        return late

    def _grow(self, needed: int) -> None:
        """More space for keys. Raises TooManyEventsError beyond the limit."""
        size = self._output.keys.size
        if size >= self.limits.most_events:
            raise TooManyEventsError
        larger = arrays.empty(min(max(needed, 2 * size), max(self.limits.most_events, size)), np.uint64)
        arrays.fill(larger[: self._written], self._output.keys[: self._written])
        self._output = self._output._replace(keys=larger)

    def _fresh_output(self, size: int) -> Output:
        counts = arrays.upload(np.array([0, NOTHING, 0], np.int64))
        numbers, motion = arrays.empty(self._pixels, np.int32), arrays.empty((4, self._pixels), np.float32)
        return Output(arrays.empty(size, np.uint64), counts, numbers, motion)

    def _traced(self, start_us: int, span_us: float) -> tuple[TracedBand, list[DeviceArray]]:
        """A band to note effects in, and the planes that its names are of."""
        states: dict[str, State] = {}
        planes: list[DeviceArray] = []
        for effect, state in self.state.items():
            states[effect] = {}
            for name, array in state.items():
                if isinstance(array, np.ndarray) and not is_plane(array, self._empty_plane):
                    states[effect][name] = array
                else:
                    row = "" if len(array.shape) == 1 else ":, "
                    states[effect][name] = named(f"planes[{len(planes)}][{row}i : i + 1]")
                    planes.append(array)
        return traced_band.traced(self.sensor, states, start_us, span_us, self._elapsed_us), planes

    @property
    def _empty_plane(self) -> Plane:
        return np.broadcast_to(np.float32(0), (self._pixels,))

    def _kicks(self, band: TracedBand) -> Kicks:
        """The timetable of a band's kicks, made on the host."""
        if not band.kicks:
            return self._no_kicks
        return Kicks(*(arrays.upload(array) for array in kicks_of_rows(band)))

    def _given(self, band: TracedBand, planes: list[DeviceArray]) -> Given:
        """What the kernel is to be given for it; never empty, since the device knows no empty group."""
        tables = [arrays.upload(table) for table in band.tables]
        return Given(
            tuple(planes) or (self._seen.light,), tuple(tables) or (self._seen.light,),
            tuple(band.numbers) or (0,),
        )  # fmt: skip

    def take_keys(self) -> DeviceArray:
        """The event keys of the steps since the last call; good until the next step."""
        keys = self._output.keys[: self._written]
        self.abandon_keys()
        return keys

    def host_keys(self, keys: DeviceArray) -> NDArray[np.uint64]:
        """Keys on the host."""
        return arrays.download(keys)

    def abandon_keys(self) -> None:
        arrays.fill(self._output.counts, np.array([0, NOTHING, 0], np.int64))
        self._written = 0

    def in_order(self, keys: DeviceArray, span_us: int) -> DeviceArray:
        """Keys of an interval of span_us, sorted."""
        return arrays.in_order(keys, key_bits(span_us))

    def abandon(self) -> None:
        """Leave the interval under way: its events are forgotten, each voltage is what it has come to."""
        self._output = self._fresh_output(max(FIRST_KEYS, self._pixels))
        self._written = 0
        self._steps += 1

    @property
    def light(self) -> Plane:
        """What the pixels saw last [DN], a copy on the host."""
        return arrays.download(self._seen.light)

    @property
    def voltage(self) -> Plane:
        """The voltages on the host, where events' effects may change them: they are taken back."""
        if self._voltage is None:
            self._voltage = arrays.download(self._state.voltage)
        return self._voltage

    def _take_back_voltage(self) -> None:
        if self._voltage is not None:
            arrays.fill(self._state.voltage, self._voltage)
            self._voltage = None

    def snapshot(self) -> dict[str, NDArray[np.generic]]:
        """Copies of all that further steps depend on, but for the parameters; the same as of `PixelArray`."""
        self._take_back_voltage()
        set_us = [self._set_us.get(effect.name, 0.0) for effect in self.effects]
        held = self._state.held if self._has_held else np.zeros(0, np.float32)
        return {
            "voltage": arrays.download(self._state.voltage),
            "pending": arrays.download(self._state.pending),
            "light": arrays.download(self._seen.light),
            "response": arrays.download(self._seen.response),
            "held": held if isinstance(held, np.ndarray) and not held.size else arrays.download(held),
            "counts": np.array([self._steps, self._steps], np.int64),
            "clocks_us": np.array([self._elapsed_us, 0.0, *set_us]),
            **{
                f"state/{effect}/{name}": arrays.on_host(array)
                for effect, state in self.state.items()
                for name, array in state.items()
            },
        }

    def restore(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Be as when `snapshot` was taken of a sensor of this size, seed, law and parameters."""
        self._voltage = None
        state, seen = self._state, self._seen
        for name, plane in (("voltage", state.voltage), ("pending", state.pending)):
            arrays.fill(plane, np.asarray(saved[name], np.float32))
        for name, plane in (("light", seen.light), ("response", seen.response)):
            arrays.fill(plane, np.asarray(saved[name], np.float32))
        if saved["held"].size:
            self._has_held = True
            arrays.fill(state.held, np.asarray(saved["held"], np.float32))
        self._steps = int(saved["counts"][0])
        self._elapsed_us, _, *set_us = saved["clocks_us"].tolist()
        self._set_us.update(zip((effect.name for effect in self.effects), set_us, strict=True))
        for effect, own in self.state.items():
            own.update(self._taken({name: np.array(saved[f"state/{effect}/{name}"]) for name in own}))

    @property
    def state_bytes(self) -> int:
        """Memory of all planes, without the events of an interval."""
        own = [*self._state, *self._seen, self._output.numbers, self._output.motion]
        own += [array for state in self.state.values() for array in state.values()]
        return sum(int(array.nbytes) for array in own)

    @property
    def event_bytes(self) -> int:
        """Memory of the space for the events of an interval."""
        return int(self._output.keys.nbytes)
