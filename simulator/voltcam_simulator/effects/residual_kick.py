"""What a pixel's own event does to it later, that nobody has a name for, as a diagnosis finds it."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..late_kicks import OWN, KickRule, kicked, late_kick_state


class ResidualKick(Effect):
    """A while after each event its pixel's voltage is kicked: up, and another ON event may follow or comes
    sooner; down, and an OFF event may, or the next ON event comes later. What a kick sets off does not kick.

    The delay is log-normal. `late_kicks` says how a path is followed through a kick.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "at some interval after an event of the pixel there are more or fewer events than any known effect"
        " gives"
    )

    feeds_back: ClassVar[bool] = True

    targets: ClassVar[NDArray[np.int64]] = OWN
    """Who is kicked, as steps in x and y from the event's pixel."""

    after_on: float = quantity(
        0.0, unit="nominal thresholds", ge=-10, le=10, meaning="kick after an ON event",
        source="found by voltcam diagnose",
    )  # fmt: skip
    after_off: float = quantity(
        0.0, unit="nominal thresholds", ge=-10, le=10, meaning="kick after an OFF event",
        source="found by voltcam diagnose",
    )  # fmt: skip
    chance: float = quantity(
        1.0, unit="1", ge=0, le=1, meaning="of a kick, after each event and for each pixel that it may kick",
        source="found by voltcam diagnose",
    )  # fmt: skip
    delay_us: float = quantity(
        1000.0, unit="us", ge=0, le=1e6, meaning="from the event to the kick, in the median",
        source="found by voltcam diagnose",
    )  # fmt: skip
    spread_decades: float = quantity(
        0.0, unit="decades", ge=0, le=1, meaning="standard deviation of log10 of the delay",
        source="found by voltcam diagnose",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.chance > 0 and (self.after_on != 0 or self.after_off != 0)

    def state(self, sensor: Sensor) -> State:
        return late_kick_state(sensor)

    def report(self, events: Events, readout: EventInterval) -> Events:
        rule = KickRule(
            self.after_on, self.after_off, self.chance, self.delay_us, self.spread_decades, self.targets
        )
        return kicked(self.name, rule, events, readout)
