"""The two comparators: how far the voltage must go for an event."""

from typing import ClassVar

from ..effect import About, Effect, Sensor, quantity

_SOURCE = "DVS-Voltmeter (ECCV 2022): both thresholds are the unit of the k's"


class Comparator(Effect):
    """ON at +theta_on, OFF at -theta_off, in units of the nominal threshold."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "events for each change of contrast; unequal thresholds shift the ON/OFF ratio"
    steady: ClassVar[bool] = True

    theta_on: float = quantity(
        1.0, unit="nominal thresholds", ge=0.001, le=100, meaning="threshold of ON events", source=_SOURCE
    )
    theta_off: float = quantity(
        1.0, unit="nominal thresholds", ge=0.001, le=100, meaning="threshold of OFF events", source=_SOURCE
    )

    def prepare(self, sensor: Sensor) -> None:
        sensor.theta_on[:] = self.theta_on
        sensor.theta_off[:] = self.theta_off
