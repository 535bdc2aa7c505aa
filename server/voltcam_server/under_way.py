"""An interval in two halves: while its pixels are drawn, the events of the interval before are reported."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Drawn, GivenUpError, Limits, Simulator
from voltcam_video import Frame

from .interval import Interval
from .overload import Load, OverloadSettings, coarser

Give = Callable[[Interval | None], None]


class DrawnPixels(NamedTuple):
    """Those of an interval, drawn."""

    events: list[NDArray[np.void]]
    """Up to the last of the frames in between."""
    drawn: Drawn | None
    """From there on."""
    start_us: int
    coarser: float
    span_us: int
    missed: int
    began_s: float


class UnderWay(NamedTuple):
    """An interval whose pixels are drawn, and whose events are still behind them."""

    interval: Interval
    """As it will be, but for its events, their end, and when they are ready."""
    pixels: DrawnPixels
    give: Give


class Pipeline:
    """Of one simulator. reported: is called with each interval, and whom to give it to."""

    def __init__(
        self,
        simulator: Simulator,
        load: Load,
        overload: OverloadSettings,
        reported: Callable[[Interval, Give], None],
    ) -> None:
        self._simulator, self._load, self._overload = simulator, load, overload
        self._reported = reported
        self._under_way: UnderWay | None = None
        self._lost: tuple[UnderWay, GivenUpError] | None = None  # its events were given up
        self._free_s = 0.0  # since when there is time for the interval at hand

    def draw(self, frames: Sequence[Frame], span_us: int, missed: int) -> DrawnPixels:
        """The pixels up to the last of these frames; meanwhile the interval before is reported.

        missed: frames that were dropped in it. Raises GivenUpError, ValueError.
        """
        began_s = time.monotonic()
        until_s, left = began_s + self._overload.longest_work_s, self._overload.most_events
        coarser = self._coarser(span_us, missed)
        events: list[NDArray[np.void]] = []

        def drawn(step: Frame) -> Drawn | None:
            limits = Limits(coarser, left, lambda: time.monotonic() > until_s)
            now = self._simulator.draw(step.image, step.t_us, limits, self.report)
            if self._lost is not None:
                raise self._lost[1]
            return now

        first, *others = frames
        try:
            last = drawn(first)
            start_us = self._simulator.complete_us  # only now is the interval before over
            for step in others:
                events.append(self._simulator.report(last))
                left -= len(events[-1])
                last = drawn(step)
        except GivenUpError:
            self._worked(began_s, span_us, missed)
            raise
        return DrawnPixels(events, last, start_us, coarser, span_us, missed, began_s)

    def leave(self, under_way: UnderWay) -> None:
        """Leave an interval under way, until `report` or the next `draw`."""
        self._under_way = under_way

    def report(self) -> None:
        """Give the interval under way, its events known now; while pixels of the next are drawn, too."""
        under_way, self._under_way = self._under_way, None
        if under_way is None:
            return
        interval, pixels, give = under_way
        try:
            pixels.events.append(self._simulator.report(pixels.drawn))
        except GivenUpError as error:
            self._lost = under_way, error  # for `take_lost`: the simulator must jump, and cannot meanwhile
            return
        finally:
            self._worked(pixels.began_s, pixels.span_us, pixels.missed)
        events = pixels.events[0] if len(pixels.events) == 1 else np.concatenate(pixels.events)
        end_us = self._simulator.complete_us
        self._reported(replace(interval, events=events, end_us=end_us, ready_s=time.monotonic()), give)
        self._free_s = time.monotonic()

    def take_lost(self) -> tuple[UnderWay, GivenUpError] | None:
        """The interval whose events were given up, and why; once. The simulator must jump then."""
        lost, self._lost = self._lost, None
        return lost

    def _worked(self, began_s: float, span_us: int, missed: int) -> None:
        """Count the time of an interval, but for what it shared with the one before."""
        self._load.worked(time.monotonic() - max(began_s, self._free_s), span_us, missed)

    def _coarser(self, span_us: int, missed: int) -> float:
        """An interval in which a frame was dropped has the steps of one without: dropping it saves work."""
        longest_us = self._simulator.parameters.longest_step_us
        return max(1.0 + missed, coarser(span_us, longest_us, self._simulator.width * self._simulator.height))
