"""The simulator: frames one by one in, time-sorted events out, every pixel's voltage kept between them."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import starmap
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .camera_file import SIDE_LIMIT
from .effect import EVENT, Events, Image, Plane
from .event_key import unpack_events
from .event_stages import NO_PLANE, EventStages
from .fixed_pattern import FixedPattern
from .law import Law
from .light_path import LightPath, span_between
from .limits import GivenUpError, Limits
from .parameters import Parameters
from .pixel_array import nothing
from .sensor_pixels import Device, device_events, sensor_pixels
from .workspace import Keys

NO_LIMITS = Limits()


class Drawn(NamedTuple):
    """An interval whose pixels are done, and whose events have the stages behind the pixels before them."""

    keys: Keys
    start_us: int
    end_us: int
    interval: int
    light: Plane
    """What the pixels see at its end."""
    limits: Limits


class Simulator:
    """A sensor that takes frames and gives events (DVS-Voltmeter: Lin, Ma, Guo and Wen, ECCV 2022).

    - `width`, `height`: pixels, 1 to 8192.
    - `parameters`: of all effects; None: the defaults. They may be assigned between two frames, and hold for
      all that follows; voltages are kept.
    - `law`: "exact", Brownian motion itself, or "paper", Algorithm 1 as published.
    - `seed`: 0 to 2^63 - 1. The same seed and frames give the same events, for any number of threads.
    - `threads`: that work on an interval, on a processor.
    - `device`: "cpu", or "cuda": a GPU, with the extra `cuda`.

    Raises ValueError for a size, law, seed or device that cannot be, NoDeviceError where there is no GPU.
    """

    def __init__(
        self,
        width: int,
        height: int,
        parameters: Parameters | None = None,
        law: Law = "exact",
        seed: int = 0,
        threads: int = 1,
        device: Device = "cpu",
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
        self._threads = threads if device == "cpu" else 1
        self.device = device
        self._pixels = sensor_pixels(device, width, height, law, seed, threads)
        self._path = LightPath(self._pixels)
        self._intervals = 0
        self._stages = EventStages(self._pixels)
        self.parameters = parameters if parameters is not None else Parameters()

    @property
    def state_bytes(self) -> int:
        """Memory of the state, without the events of an interval."""
        frame = 0 if self._path.image is None else self._path.image.nbytes
        return self._pixels.state_bytes + frame

    @property
    def event_bytes(self) -> int:
        """Memory of the space for the events of an interval, which grows to what the busiest one needs."""
        return self._pixels.event_bytes

    @property
    def complete_us(self) -> int:
        """No event to come is stamped earlier: the time of the last frame, or before, where an effect stamps
        events earlier than they were."""
        return self._stages.complete_us

    @property
    def parameters(self) -> Parameters:
        """What the sensor is set to."""
        return self._parameters

    @parameters.setter
    def parameters(self, parameters: Parameters) -> None:
        self.take(self.laid_down(parameters))

    def laid_down(self, parameters: Parameters) -> FixedPattern:
        """The fixed pattern of the sensor for these parameters, for `take`; changes nothing.

        It may be made in another thread than the one that calls `advance`: on a large sensor it takes time.
        """
        return self._pixels.laid_down(parameters)

    def take(self, pattern: FixedPattern) -> None:
        """Set the parameters for which `laid_down` has made this pattern."""
        parameters = pattern.parameters
        self._pixels.configure(pattern)
        self._stages.configure(parameters)
        self._parameters = parameters
        if self._path.image is not None:  # the same light gives another voltage: that is no change of light
            self._pixels.settle(self._path.image, self._path.t_us)

    def advance(self, frame: ArrayLike, t_us: int, limits: Limits = NO_LIMITS) -> Events:
        """The events between the last frame and this one, sorted by time.

        frame: (height, width) grey levels, 0..255 DN unless the parameters say otherwise; any real dtype.
        On "cuda" also an array on the device, of a library that has `__cuda_array_interface__` or DLPack.
        t_us: its time, int microseconds, later than the last one. The first frame gives no events.
        Returns an array of dtype EVENT. Raises ValueError, with nothing changed, for a wrong shape, values
        that are negative or above 1e12, or a time that does not advance; and GivenUpError beyond the limits,
        with the sensor somewhere on the way to the frame: `jump` to a frame to go on.
        """
        return self.report(self.draw(frame, t_us, limits))

    def advance_on_device(self, frame: Any, t_us: int, limits: Limits = NO_LIMITS) -> Any:
        """The same as `advance`, its events left on the GPU: `cuda.events.DeviceEvents`.

        Effects that act on events (latency, readout, ...) work on the host: where one is on, events go there
        and back. Raises ValueError on "cpu".
        """
        if self.device == "cpu":
            raise ValueError("device cpu has its events on the host: call advance")
        from .cuda.events import left_there

        drawn = self.draw(frame, t_us, limits)
        return left_there(None if drawn is None else self._reported_on_device(drawn))

    def draw(
        self, frame: Any, t_us: int, limits: Limits = NO_LIMITS, meanwhile: Callable[[], None] = nothing
    ) -> Drawn | None:
        """The first half of `advance`, the pixels; None for the first frame. The other half is `report`.

        meanwhile: what this thread does while others work on pixels, or else before; at most the report of
        the interval before. Until there is one, nothing but this may be done with the sensor. Raises as
        `advance` does; where it is ValueError, meanwhile has not been called.
        """
        image = self._pixels.image(frame)
        if self._path.image is None:
            self._jumped(image, t_us)
            return None
        start_us = self._path.t_us
        span_between(start_us, t_us, start_us)
        if self._threads == 1 or self._stages.feed_back:
            meanwhile()
            meanwhile = nothing
        try:
            self._path.follow(image, t_us, start_us, limits, meanwhile)
            drawn = self._drawn(start_us, t_us, limits)
        except GivenUpError:
            self._pixels.abandon()
            raise
        self._path.image, self._path.t_us = image, t_us
        return drawn

    def advance_along(self, frames: Iterable[tuple[ArrayLike, int]]) -> Events:
        """The events from the last frame to the last of these (frame, t_us), in one array: those of `advance`
        for each, in law. Effects that act on events see one interval, unless they change voltages or look at
        light: fewer calls a frame, which a small sensor feels.

        Raises as `advance` does, and what `frames` raises: with the sensor at the last frame before, whose
        events are lost.
        """
        if self._stages.feed_back or self._stages.see_light:
            return np.concatenate([np.empty(0, EVENT), *starmap(self.advance, frames)])
        path = iter(frames)
        if self._path.image is None and (first := next(path, None)):
            self._jumped(self._pixels.image(first[0]), first[1])
        start_us = self._path.t_us
        try:
            self._path.follow_all(path, start_us, NO_LIMITS)
        except BaseException:
            self._pixels.abandon()
            raise
        if self._path.t_us == start_us:
            return np.empty(0, EVENT)
        return self.report(self._drawn(start_us, self._path.t_us, NO_LIMITS))

    def stream(self, frames: Iterable[tuple[ArrayLike, int]]) -> Iterator[Events]:
        """The events of `advance` for each (frame, t_us), one after the other.

        With several threads, events of an interval go through the stages behind the pixels while the pixels
        of the next are drawn; so a frame is read before the events of the one before it are given. Until
        the last are given, nothing else may be done with the sensor. Raises as `advance` does, and what
        `frames` raises, after the events of the frames before.
        """
        if self._threads == 1 or self._stages.feed_back:
            for frame, t_us in frames:
                yield self.advance(frame, t_us)
            return
        behind: list[Drawn] = []  # one at most, as of done
        done: list[Events] = []

        def report() -> None:
            while behind:
                done.append(self.report(behind.pop()))

        try:
            for frame, t_us in frames:
                drawn = self.draw(frame, t_us, meanwhile=report)
                if drawn is None:
                    yield np.empty(0, EVENT)
                else:
                    behind.append(drawn)
                while done:
                    yield done.pop()
        except Exception:
            report()
            yield from done
            raise
        report()
        yield from done

    def _drawn(self, start_us: int, end_us: int, limits: Limits) -> Drawn:
        """What the pixels have drawn since start_us, which ends an interval. Raises GivenUpError."""
        light = self._pixels.light if self._stages.see_light else NO_PLANE
        if self._threads > 1:
            light = light.copy()
        drawn = Drawn(self._pixels.take_keys(), start_us, end_us, self._intervals, light, limits)
        self._intervals += 1
        return drawn

    def report(self, drawn: Drawn | None) -> Events:
        """The other half of `advance`: the events of what was drawn that leave the camera, in the order of
        drawing; none for None. Raises GivenUpError: `jump` to a frame to go on."""
        if drawn is None:
            return np.empty(0, EVENT)
        start_us = drawn.start_us
        keys = self._pixels.host_keys(self._in_order(drawn))
        events = np.empty(keys.size, EVENT)
        unpack_events(keys, start_us, events)
        return self._stages.passed(events, start_us, drawn.end_us, drawn.interval, drawn.light, drawn.limits)

    def _reported_on_device(self, drawn: Drawn) -> Any:
        """The same on the GPU, or on the host behind effects that act on events."""
        if not self._stages.idle:
            return self.report(drawn)
        self._stages.pass_by(drawn.end_us)
        return device_events(self._in_order(drawn), drawn.start_us)

    def _in_order(self, drawn: Drawn) -> Any:
        return self._pixels.in_order(drawn.keys, drawn.end_us - drawn.start_us)

    def jump(self, frame: ArrayLike, t_us: int) -> None:
        """Go on from another frame and time, earlier or later, with no events for the change.

        A new time line begins: events of the old one that are still on their way are lost. Where it goes on
        forward, no event is stamped before those of the old one.
        """
        self._jumped(self._pixels.image(frame), t_us)

    def _jumped(self, image: Image, t_us: int) -> None:
        first = self._path.image is None
        self._pixels.settle(image, t_us)
        if first:
            self._pixels.start(t_us)
        self._stages.restart(t_us, goes_on=t_us >= self._path.t_us and not first)
        self._path.image, self._path.t_us = image, t_us

    def snapshot(self) -> dict[str, NDArray[Any]]:
        """Copies of all that events to come depend on, but for size, law, seed and parameters.

        A `Simulator` made with these, and given it by `restore`, gives the same events for the same frames.
        Raises ValueError before the first frame.
        """
        if self._path.image is None:
            raise ValueError("there is no state yet: give a frame first")
        stages = self._stages
        return {
            **self._pixels.snapshot(),
            "frame": self._pixels.host_image(self._path.image),
            "times_us": np.array(
                [self._path.t_us, stages.read_us, stages.complete_us, self._intervals], np.int64
            ),
            **{f"waiting/{effect}": events.copy() for effect, events in stages.waiting.items()},
        }

    def restore(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Go on as the simulator that a `snapshot` was taken of. Raises KeyError or ValueError for others."""
        self._pixels.restore(saved)
        self._path.image = self._pixels.image(saved["frame"])
        self._path.t_us, read_us, complete_us, self._intervals = saved["times_us"].tolist()
        self._stages.read_us, self._stages.complete_us = read_us, complete_us
        begin = "waiting/"
        self._stages.waiting = {
            name.removeprefix(begin): saved[name].astype(EVENT) for name in saved if name.startswith(begin)
        }
