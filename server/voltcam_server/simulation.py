"""From frames to intervals of events: the simulator, its parameters as they change, and one time line."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import (
    EVENT,
    Camera,
    Device,
    Drawn,
    GivenUpError,
    Law,
    Limits,
    Parameters,
    Simulator,
)
from voltcam_video import VIDEO_GAMMA, Frame, Image, fit

from .beside import BesideEvents, DavisSettings
from .camera_settings import Upsample
from .compiling import CompiledEffects
from .cores import threads_for
from .interval import How, Interval, SimulationSetup, Start
from .mailbox import Arrival
from .overload import Load, OverloadSettings, coarser
from .parameter_changes import ParameterChanges
from .problems import one_line
from .upsampling import Upsampling

PATIENCE_FRAMES = 10  # so many stamps in a row that do not advance mean that the source's clock was set back
FIRST_PERIOD_US = 33_333
Give = Callable[[Interval | None], None]


class UnderWay(NamedTuple):
    """An interval whose pixels are drawn, and whose events are still behind them."""

    interval: Interval
    """As it will be, but for its events, their end, and when they are ready."""
    events: list[NDArray[np.void]]
    """Up to the last of the frames in between."""
    drawn: Drawn | None
    """From there on."""
    give: Give
    span_us: int
    missed: int
    began_s: float


class Simulation:
    """A camera fed frame by frame; `change` may be called from any thread.

    Times run on across cuts and changes of source: a frame that starts again at an earlier time is moved to
    one frame period after the last one, and those after it likewise. With upsample "cubic" frames are taken
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
        self.out_of_order = 0
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
        self._last_us: int | None = None
        self._shift_us = 0
        self._period_us = FIRST_PERIOD_US
        self._stuck = 0
        self._under_way: UnderWay | None = None
        self._lost: tuple[UnderWay, GivenUpError] | None = None  # its events were given up
        self._free_s = 0.0  # since when there is time for the interval at hand

    @property
    def parameters(self) -> tuple[Parameters, int]:
        """The newest parameters and their version; they hold from the next interval on."""
        return self._changes.newest

    @property
    def shift_us(self) -> int:
        """What is added to the times of the source's frames."""
        return self._shift_us

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
        self._report()
        if self._lost is not None:
            (interval, *_, give, span_us, _, _), error = self._lost
            self._lost = None
            give(self._given_up(interval, span_us, error))

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
            {} if self._last_us is None else self._simulator.snapshot(),
            follows=self._upsampling.follows,
            parameters=self._simulator.parameters,
            parameters_version=self._changes.version,
            source=source,
        )

    def _step(self, arrival: Arrival, give: Give) -> None:
        """Give what `step` returns, or leave it under way."""
        t_us = arrival.frame.t_us + self._shift_us
        span_us = 0 if self._last_us is None else t_us - self._last_us
        cut = arrival.cut or self._last_us is None
        if not cut and span_us <= 0:
            self._stuck += 1
            if self._stuck <= PATIENCE_FRAMES:
                self.out_of_order += 1
                self.finish()
                give(None)
                return
            cut = True
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
        start_us = t_us if cut or self._last_us is None else self._last_us
        if len(events):
            start_us = min(start_us, int(events["t"][0]))
        self.simulated += 1
        return self._done(events, start_us, Frame(image, t_us), arrival, "replayed")

    def _draw(self, frame: Frame, span_us: int, arrival: Arrival, give: Give) -> None:
        """The pixels up to a frame; the interval is under way then. Raises GivenUpError, ValueError."""
        first, *others = self._upsampling.up_to(frame, self._shift_us)
        began_s = time.monotonic()
        until_s, left = began_s + self._overload.longest_work_s, self._overload.most_events
        coarser = self._coarser(span_us, arrival.missed)
        events: list[NDArray[np.void]] = []

        def drawn(step: Frame) -> Drawn | None:
            limits = Limits(coarser, left, lambda: time.monotonic() > until_s)
            now = self._simulator.draw(step.image, step.t_us, limits, self._report)
            if self._lost is not None:
                raise self._lost[1]
            return now

        try:
            last = drawn(first)
            start_us = self._simulator.complete_us  # only now is the interval before over
            for step in others:
                events.append(self._simulator.report(last))
                left -= len(events[-1])
                last = drawn(step)
        except GivenUpError:
            self._worked(began_s, span_us, arrival.missed)
            raise
        self._period_us = span_us // (1 + arrival.missed)
        interval = self._done(np.empty(0, EVENT), start_us, frame, arrival, "advanced", coarser)
        self._under_way = UnderWay(interval, events, last, give, span_us, arrival.missed, began_s)

    def _report(self) -> None:
        """Give the interval under way, its events known now; while pixels of the next are drawn, too."""
        under_way, self._under_way = self._under_way, None
        if under_way is None:
            return
        try:
            under_way.events.append(self._simulator.report(under_way.drawn))
        except GivenUpError as error:
            self._lost = under_way, error  # for `finish`: the simulator must jump, which it cannot meanwhile
            return
        finally:
            self._worked(under_way.began_s, under_way.span_us, under_way.missed)
        self.simulated += 1
        events = under_way.events
        under_way.give(
            replace(
                under_way.interval,
                events=events[0] if len(events) == 1 else np.concatenate(events),
                end_us=self._simulator.complete_us,
                ready_s=time.monotonic(),
            )
        )
        self._free_s = time.monotonic()

    def _worked(self, began_s: float, span_us: int, missed: int) -> None:
        """Count the time of an interval, but for what it shared with the one before."""
        self.load.worked(time.monotonic() - max(began_s, self._free_s), span_us, missed)

    def _coarser(self, span_us: int, missed: int) -> float:
        """An interval in which a frame was dropped has the steps of one without: dropping it saves work."""
        pixels = self.camera.width * self.camera.height
        longest_us = self._simulator.parameters.longest_step_us
        return max(1.0 + missed, coarser(span_us, longest_us, pixels))

    def _cut(self, image: Image, arrival: Arrival) -> Interval:
        """Go on from a frame that does not follow from the last one: no events for the change."""
        t_us, last_us = arrival.frame.t_us, self._last_us
        # No shift where time goes on by itself: cameras on one clock must stay on it.
        shift_us = 0 if last_us is None or t_us > last_us else last_us + self._period_us - t_us
        t_us += shift_us
        self.simulated += 1
        self._shift_us = shift_us
        return self._jump(image, t_us, arrival)

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
        self._last_us = frame.t_us
        self._upsampling.went_on(frame)
        self._stuck = 0
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
