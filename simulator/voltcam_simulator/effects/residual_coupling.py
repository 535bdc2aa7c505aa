"""What an event does to its neighbours, that nobody has a name for, as a diagnosis finds it."""

from typing import ClassVar

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..late_kicks import NEIGHBOURS, KickRule, kicked, late_kick_state


class ResidualCoupling(Effect):
    """A while after each event the voltages of its four neighbours are kicked, each by itself: up or down.
    What a kick sets off does not kick. With no delay, sizes of both signs alike and a chance of 1 it is
    `crosstalk`, which is the listed effect of this kind.

    The delay is log-normal. `late_kicks` says how a path is followed through a kick.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "at some interval after a neighbour's event there are more or fewer events than any known effect"
        " gives"
    )

    feeds_back: ClassVar[bool] = True

    after_on: float = quantity(
        0.0, unit="nominal thresholds", ge=-10, le=10, meaning="kick after an ON event",
        source="found by voltcam diagnose",
    )  # fmt: skip
    after_off: float = quantity(
        0.0, unit="nominal thresholds", ge=-10, le=10, meaning="kick after an OFF event",
        source="found by voltcam diagnose",
    )  # fmt: skip
    chance: float = quantity(
        1.0, unit="1", ge=0, le=1, meaning="share of the neighbours that are kicked",
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
            self.after_on, self.after_off, self.chance, self.delay_us, self.spread_decades, NEIGHBOURS
        )
        return kicked(self.name, rule, events, readout)
