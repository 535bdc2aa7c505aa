"""Events on their way from the pixels to the user, through the effects that `report`, one after the other."""

from dataclasses import replace

import numpy as np

from .effect import EventInterval, Events, Plane, overrides
from .event_order import copied, merged, place_of
from .limits import Limits
from .parameters import Parameters
from .sensor_pixels import SensorPixels

NO_PLANE = np.empty(0, np.float32)
"""In the place of a plane that nobody looks at."""


class EventStages:
    """What is behind the pixels. Events that an effect has given out, and that are not due yet, wait here."""

    def __init__(self, pixels: SensorPixels) -> None:
        self._pixels = pixels
        self.read_us = 0
        """Up to when events have been through all stages."""
        self.complete_us = 0
        """The same on the clock that stamps them."""
        self.waiting: dict[str, Events] = {}
        """By effect: events it has given out that are not due yet."""
        self.feed_back = False
        """Whether events on their way change the pixels."""
        self.see_light = False
        """Whether `passed` needs the light."""

    def configure(self, parameters: Parameters) -> None:
        """Take on parameters; what waits goes on."""
        self._effects = [effect for effect in parameters.effects() if overrides(effect, "report")]
        on = [effect for effect in self._effects if effect.active]
        self._active = {effect.name for effect in on}
        self.feed_back = any(effect.feeds_back for effect in on)
        self.see_light = any(effect.sees_light for effect in on)

    def restart(self, t_us: int, goes_on: bool) -> None:
        """Forget events on their way; goes_on: no event to come is stamped before those that have left."""
        self._pixels.forget_events()
        self.waiting.clear()
        former_us = self.complete_us if goes_on else self._stamped(t_us)
        self.read_us, self.complete_us = t_us, max(former_us, self._stamped(t_us))

    def passed(
        self, events: Events, start_us: int, end_us: int, interval: int, light: Plane, limits: Limits
    ) -> Events:
        """What leaves the camera by end_us of the pixels' events from start_us on, and of those before.

        light (pixels,): what the pixels see at end_us [DN], where they `see_light`. Raises GivenUpError.
        """
        if self.idle:
            self.pass_by(end_us)
            return events
        pixels = self._pixels
        voltage = pixels.voltage if self.feed_back else NO_PLANE
        readout = EventInterval(
            pixels.sensor, start_us, end_us, interval, pixels.state, voltage, light, limits,
        )  # fmt: skip
        for effect in self._effects:
            if effect.name not in self._active and effect.name not in self.waiting:
                continue
            if effect.name in self._active:
                events = effect.report(events, readout)
                readout.admit(len(events))
                if effect.earliest_us > 0:
                    readout = self._earlier(readout, effect.earliest_us)
                    np.maximum(events["t"], readout.start_us, out=events["t"])  # it may just have begun to
            events = self._due(effect.name, events, readout)  # also of one just switched off
        if len(events) and events["t"][0] < self.complete_us:  # the clock has just become coarser
            np.maximum(events["t"], self.complete_us, out=events["t"])
        self.read_us = readout.end_us
        self.complete_us = max(self.complete_us, self._stamped(readout.end_us))
        return events

    @property
    def idle(self) -> bool:
        """Whether events leave as they come: no effect is on, and none waits."""
        return not (self.waiting or self._active)

    def pass_by(self, end_us: int) -> None:
        """An interval is over whose events have left as they came."""
        self.read_us = self.complete_us = end_us

    def _stamped(self, t_us: int) -> int:
        """The earliest stamp of what is still to come at t_us."""
        for effect in self._effects:
            t_us = effect.stamp_us(t_us)
        return t_us

    def _earlier(self, readout: EventInterval, by_us: int) -> EventInterval:
        """The interval whose events are complete when those to come may be stamped so much earlier."""
        return replace(readout, start_us=self.read_us, end_us=max(self.read_us, readout.end_us - by_us))

    def _due(self, stage: str, events: Events, readout: EventInterval) -> Events:
        """What an effect has given out, now and before, that is due in the interval; the rest waits."""
        if stage in self.waiting:
            waiting = self.waiting.pop(stage)
            readout.admit(len(waiting) + len(events))
            events = merged(waiting, events)
        due = place_of(events, 0, readout.end_us + 1)
        if due < len(events):
            events, self.waiting[stage] = events[:due], copied(events[due:])
        return events
