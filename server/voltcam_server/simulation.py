"""From frames to intervals of events: the simulator, its parameters as they change, and one time line."""

import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import (
    EVENT,
    Camera,
    Device,
    GivenUpError,
    Law,
    Limits,
    Parameters,
    Simulator,
    TooManyEventsError,
)
from voltcam_video import VIDEO_GAMMA, Frame, Image, along_cubic, along_flow, fit, follows

from .beside import BesideEvents, DavisSettings
from .camera_settings import Upsample
from .compiling import CompiledEffects
from .cores import threads_for
from .interval import How, Interval, SimulationSetup, Start
from .mailbox import Arrival
from .overload import TOO_FAST, Load, OverloadSettings, coarser
from .parameter_changes import ParameterChanges
from .problems import one_line

MISSED_AT_LEAST = 2  # dropped frames, of which what was between is skipped
MOST_PERIODS = 2  # of frames, that simulating it may take: on a machine that was late for once it is not
PATIENCE_FRAMES = 10  # so many stamps in a row that do not advance mean that the source's clock was set back
FIRST_PERIOD_US = 33_333


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
        self._upsample: Upsample = upsample
        self._next: Arrival | None = None  # with "cubic": what comes after the frame at hand
        self._before: Frame | None = None  # the last two frames, as simulated
        self._former: Frame | None = None
        self._last_us: int | None = None
        self._shift_us = 0
        self._period_us = FIRST_PERIOD_US
        self._stuck = 0

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
        if self._upsample != "cubic":
            return self._step(arrival)
        current, self._next = self._next, arrival
        return None if current is None else self._step(current)

    @property
    def setup(self) -> SimulationSetup:
        """What all its intervals are made with."""
        return SimulationSetup(
            self.camera, self._law, self._simulator.seed, self._upsample, self._davis.frames
        )

    def start_of(self, source: str) -> Start:
        """The sensor before the next interval. For the thread that calls `step`."""
        self._changes.take()
        return Start(
            {} if self._last_us is None else self._simulator.snapshot(),
            follows=self._former is not None,
            parameters=self._simulator.parameters,
            parameters_version=self._changes.version,
            source=source,
        )

    def _step(self, arrival: Arrival) -> Interval | None:
        t_us = arrival.frame.t_us + self._shift_us
        span_us = 0 if self._last_us is None else t_us - self._last_us
        cut = arrival.cut or self._last_us is None
        if not cut and span_us <= 0:
            self._stuck += 1
            if self._stuck <= PATIENCE_FRAMES:
                self.out_of_order += 1
                return None
            cut = True
        image = fit(arrival.frame.image, self.camera.width, self.camera.height, arrival.fit)
        self._changes.take(arrival.frame.gamma)
        try:
            if arrival.frame.events is not None:
                return self._replay(image, arrival.frame.events, t_us, cut, arrival)
            if cut:
                return self._cut(image, arrival)
            if arrival.missed:
                self.load.dropped()
            why = self._too_much(span_us, arrival.missed)
            if why:
                return self._skip(image, t_us, span_us, arrival, why)
            return self._advance(image, t_us, span_us, arrival)
        except GivenUpError as error:
            overload = self._overload
            why = f"more than {overload.most_events} events between two frames"
            if not isinstance(error, TooManyEventsError):
                why = f"one interval takes more than {overload.longest_work_s:g} s"
            return self._skip(image, t_us, span_us, arrival, why, "given up")
        except ValueError as error:  # grey levels that are none; the simulator has changed nothing
            self.unusable += 1
            self.fault = one_line(error)
            return None

    def _replay(
        self, image: Image, events: NDArray[np.void], t_us: int, cut: bool, arrival: Arrival
    ) -> Interval:
        """An interval of a recording, as it is. Raises ValueError for one of another camera."""
        if arrival.frame.image.shape != (self.camera.height, self.camera.width):
            height, width = arrival.frame.image.shape
            raise ValueError(f"a recording of {width} x {height} pixels needs a camera of that size")
        start_us = t_us if cut or self._last_us is None else self._last_us
        if len(events):
            start_us = min(start_us, int(events["t"][0]))
        self.simulated += 1
        return self._done(events, start_us, Frame(image, t_us), arrival, "replayed")

    def _advance(self, image: Image, t_us: int, span_us: int, arrival: Arrival) -> Interval:
        frame = Frame(image, t_us)
        steps = [*self._in_between(frame), frame]
        start_us, began_s = self._simulator.complete_us, time.monotonic()
        try:
            coarser = self._coarser(span_us, arrival.missed)
            all_events = self._events(steps, coarser)
        finally:
            self.load.worked(time.monotonic() - began_s, span_us, arrival.missed)
        self._period_us = span_us // (1 + arrival.missed)
        self.simulated += 1
        return self._done(all_events, start_us, frame, arrival, "advanced", coarser)

    def _events(self, steps: list[Frame], coarser: float) -> NDArray[np.void]:
        """The events up to the last of these frames. Raises GivenUpError."""
        events, left = [], self._overload.most_events
        until_s = time.monotonic() + self._overload.longest_work_s
        for step in steps:
            limits = Limits(coarser, left, lambda: time.monotonic() > until_s)
            events.append(self._simulator.advance(step.image, step.t_us, limits))
            left -= len(events[-1])
        return events[0] if len(events) == 1 else np.concatenate(events)

    def _coarser(self, span_us: int, missed: int) -> float:
        """An interval in which a frame was dropped has the steps of one without: dropping it saves work."""
        pixels = self.camera.width * self.camera.height
        longest_us = self._simulator.parameters.longest_step_us
        return max(1.0 + missed, coarser(span_us, longest_us, pixels))

    def _too_much(self, span_us: int, missed: int) -> str:
        """Why an interval is not simulated; empty when it is."""
        longest_us = self._overload.longest_interval_us
        if missed >= MISSED_AT_LEAST and (1 + missed) * self.load.ratio > MOST_PERIODS:
            return TOO_FAST
        if span_us > longest_us:
            return f"{span_us / 1e6:.3g} s between two frames, more than overload.longest_interval_us allows"
        return ""

    def _in_between(self, frame: Frame) -> Iterator[Frame]:
        """The frames between the former one and this."""
        if self._former is None or self._upsample in ("off", "linear"):
            return iter(())
        if self._upsample == "cubic":
            return along_cubic(self._before, self._former, frame, self._after(frame))
        steps = self._upsample if isinstance(self._upsample, int) else None
        return along_flow(self._former, frame, steps)

    def _after(self, frame: Frame) -> Frame | None:
        """The frame that comes next, where the scene goes on to it."""
        if self._next is None or self._next.cut:
            return None
        image = fit(self._next.frame.image, self.camera.width, self.camera.height, self._next.fit)
        after = Frame(image, self._next.frame.t_us + self._shift_us)
        return after if follows(frame, after) else None

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
        self.load.skipped(why)
        self.skipped += 1
        self.skipped_us += span_us
        return self._jump(image, t_us, arrival, how)

    def _jump(self, image: Image, t_us: int, arrival: Arrival, how: How = "jumped") -> Interval:
        self._simulator.jump(image, t_us)
        self._former = None
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
        self._before, self._former = self._former, frame
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
