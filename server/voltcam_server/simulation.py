"""From frames to intervals of events: the simulator, its parameters as they change, and one time line."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import (
    EVENT,
    Camera,
    Device,
    GivenUpError,
    Law,
    Parameters,
    Simulator,
)
from voltcam_video import VIDEO_GAMMA, Frame, Image, fit

from .beside import BesideEvents, DavisSettings
from .camera_settings import Upsample
from .camera_time import CameraTime
from .compiling import CompiledEffects
from .cores import threads_for
from .interval import How, Interval, SimulationSetup, Start
from .mailbox import Arrival
from .overload import Load, OverloadSettings
from .parameter_changes import ParameterChanges
from .problems import one_line
from .under_way import Give, Pipeline, UnderWay
from .upsampling import Upsampling


class Simulation:
    """A camera fed frame by frame; `change` may be called from any thread.

    Times run on across cuts and changes of source, see `CameraTime`. With upsample "cubic" frames are taken
    one later, when the curve beyond them is known.

    What is too much is skipped: an interval with two or more dropped frames in it that would take long, one
    that is too long, one with too many events. The next interval goes on from the frame at its end.
    """

    def __init__(
        self,
        camera: Camera,
        law: Law,
        seed: int,
        upsample: Upsample = "off",
        overload: OverloadSettings | None = None,
        davis: DavisSettings | None = None,
        device: Device = "cpu",
    ) -> None:
        self.camera = camera
        self._davis = davis or DavisSettings()
        self._beside = BesideEvents(camera, seed, self._davis)
        self._law: Law = law
        self._overload = overload or OverloadSettings()
        self.load = Load()
        self.simulated = 0
        self.skipped = 0  # frames up to which nothing was simulated
        self.skipped_us = 0  # the time up to them
        self.unusable = 0
        self.fault = ""  # why the last unusable frame was one
        self._compiled = CompiledEffects(law, device)
        self.prepare(camera.parameters)
        size = camera.width, camera.height
        self._simulator = Simulator(
            *size, camera.parameters, law, seed, threads_for(*size, live=True), device
        )
        self._changes = ParameterChanges(self._simulator)
        self._upsampling = Upsampling(upsample, camera)
        self._times = CameraTime()
        self._pipeline = Pipeline(self._simulator, self.load, self._overload, self._reported)

    @property
    def parameters(self) -> tuple[Parameters, int]:
        """The newest parameters and their version; they hold from the next interval on."""
        return self._changes.newest

    @property
    def shift_us(self) -> int:
        """What is added to the times of the source's frames."""
        return self._times.shift_us

    @property
    def out_of_order(self) -> int:
        """How many frames there were whose time did not advance."""
        return self._times.out_of_order

    def change(self, changes: Mapping[str, Any]) -> tuple[Parameters, int]:
        """Change parameters, all at once, from the next interval on; returns them and their version.

        Raises pydantic.ValidationError, with nothing changed.
        """
        return self._changes.change(changes)

    def prepare(self, parameters: Parameters) -> None:
        """Have compiled what these parameters need, so that no frame need wait seconds for it."""
        self._compiled.prepare(parameters.seen_through(VIDEO_GAMMA))

    def step(self, arrival: Arrival) -> Interval | None:
        """The interval that this frame ends; None for a frame that cannot be used, which is counted."""
        given: list[Interval | None] = []
        self.follow(arrival, given.append)
        return given[0]

    def follow(self, arrival: Arrival, give: Give, more_waits: Callable[[], bool] = lambda: False) -> None:
        """Simulate up to a frame. give: is called with what `step` returns.

        more_waits: whether the next frame is there already, once the pixels of this one are drawn. Then the
        interval is left under way, and given in the next call, while the pixels of that frame are drawn.
        """
        current = self._upsampling.next(arrival)
        if current is None:
            give(None)
            return
        self._step(current, give)
        if not more_waits():
            self.finish()

    def finish(self) -> None:
        """Give the interval that is under way, if there is one. For the thread that calls `follow`."""
        self._pipeline.report()
        if (lost := self._pipeline.take_lost()) is not None:
            (interval, pixels, give), error = lost
            give(self._given_up(interval, pixels.span_us, error))

    @property
    def setup(self) -> SimulationSetup:
        """What all its intervals are made with."""
        return SimulationSetup(
            self.camera, self._law, self._simulator.seed, self._upsampling.how, self._davis.frames
        )

    def start_of(self, source: str) -> Start:
        """The sensor before the next interval. For the thread that calls `step`."""
        self.finish()
        self._changes.take()
        return Start(
            {} if self._times.last_us is None else self._simulator.snapshot(),
            follows=self._upsampling.follows,
            parameters=self._simulator.parameters,
            parameters_version=self._changes.version,
            source=source,
        )

    def _step(self, arrival: Arrival, give: Give) -> None:
        """Give what `step` returns, or leave it under way."""
        place = self._times.place(arrival.frame.t_us, arrival.cut)
        if place is None:
            self.finish()
            give(None)
            return
        t_us, span_us, cut = place
        image = fit(arrival.frame.image, self.camera.width, self.camera.height, arrival.fit)
        self._changes.take(arrival.frame.gamma, self.finish)
        if arrival.missed and not cut:
            self.load.dropped()
        why = "" if cut else self.load.too_much(span_us, arrival.missed, self._overload)
        interval: Interval | None = None
        try:
            if arrival.frame.events is not None:
                interval = self._replay(image, arrival.frame.events, t_us, cut, arrival)
            elif cut:
                interval = self._cut(image, arrival)
            elif why:
                interval = self._skip(image, t_us, span_us, arrival, why)
            else:
                self._draw(Frame(image, t_us), span_us, arrival, give)
                return
        except GivenUpError as error:
            self.finish()
            interval = self._skip(image, t_us, span_us, arrival, self._overload.words(error), "given up")
        except ValueError as error:  # grey levels that are none; the simulator has changed nothing
            self.unusable += 1
            self.fault = one_line(error)
            self.finish()
        give(interval)

    def _replay(
        self, image: Image, events: NDArray[np.void], t_us: int, cut: bool, arrival: Arrival
    ) -> Interval:
        """An interval of a recording, as it is. Raises ValueError for one of another camera."""
        if arrival.frame.image.shape != (self.camera.height, self.camera.width):
            height, width = arrival.frame.image.shape
            raise ValueError(f"a recording of {width} x {height} pixels needs a camera of that size")
        self.finish()
        last_us = self._times.last_us
        start_us = t_us if cut or last_us is None else last_us
        if len(events):
            start_us = min(start_us, int(events["t"][0]))
        self.simulated += 1
        return self._done(events, start_us, Frame(image, t_us), arrival, "replayed")

    def _draw(self, frame: Frame, span_us: int, arrival: Arrival, give: Give) -> None:
        """The pixels up to a frame; the interval is under way then. Raises GivenUpError, ValueError."""
        frames = self._upsampling.up_to(frame, self.shift_us)
        pixels = self._pipeline.draw(frames, span_us, arrival.missed)
        self._times.period_us = span_us // (1 + arrival.missed)
        nothing = np.empty(0, EVENT)
        interval = self._done(nothing, pixels.start_us, frame, arrival, "advanced", pixels.coarser)
        self._pipeline.leave(UnderWay(interval, pixels, give))

    def _reported(self, interval: Interval, give: Give) -> None:
        self.simulated += 1
        give(interval)

    def _cut(self, image: Image, arrival: Arrival) -> Interval:
        """Go on from a frame that does not follow from the last one: no events for the change."""
        self.simulated += 1
        return self._jump(image, self._times.restart(arrival.frame.t_us), arrival)

    def _skip(
        self, image: Image, t_us: int, span_us: int, arrival: Arrival, why: str, how: How = "jumped"
    ) -> Interval:
        """Go on from a frame without the events up to it, which are too many, or of too long a time."""
        self.finish()
        self._count_skipped(span_us, why)
        return self._jump(image, t_us, arrival, how)

    def _given_up(self, interval: Interval, span_us: int, error: GivenUpError) -> Interval:
        """One whose pixels are drawn, but whose events were given up: go on from its end."""
        self._count_skipped(span_us, self._overload.words(error))
        self._simulator.jump(interval.image, interval.frame_us)
        self._upsampling.cut()
        now_us = self._simulator.complete_us
        return replace(interval, how="given up", start_us=now_us, end_us=now_us, ready_s=time.monotonic())

    def _count_skipped(self, span_us: int, why: str) -> None:
        self.load.skipped(why)
        self.skipped += 1
        self.skipped_us += span_us

    def _jump(self, image: Image, t_us: int, arrival: Arrival, how: How = "jumped") -> Interval:
        self.finish()
        self._simulator.jump(image, t_us)
        self._upsampling.cut()
        return self._done(np.empty(0, EVENT), self._simulator.complete_us, Frame(image, t_us), arrival, how)

    def _done(
        self,
        events: NDArray[np.void],
        start_us: int,
        frame: Frame,
        arrival: Arrival,
        how: How,
        coarser: float = 1.0,
    ) -> Interval:
        self._times.went_on(frame.t_us)
        self._upsampling.went_on(frame)
        parameters = self._simulator.parameters
        beside = self._beside.until(frame.image, frame.t_us, parameters, jumped=how in ("jumped", "given up"))
        return Interval(
            events,
            start_us,
            frame.t_us if how == "replayed" else self._simulator.complete_us,
            frame.t_us,
            frame.image,
            parameters,
            self._changes.version,
            how,
            coarser,
            arrival.at_s,
            time.monotonic(),
            arrival.paced,
            beside,
            arrival.frame.gamma,
        )
