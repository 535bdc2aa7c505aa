"""After an event the pixel is held in reset for a while."""

from typing import ClassVar

from ..effect import About, Effect, Sensor, quantity


class RefractoryPeriod(Effect):
    """For period_us after an event the voltage stays at 0; what light and noise do meanwhile is lost."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "no two events of a pixel closer than the period; a rate r falls to r/(1 + r period)"
    )

    period_us: float = quantity(
        0.0, unit="us", ge=0, le=1e6, meaning="dead time after each event",
        source="500 v2e, noisy 10000 (Hu, Liu, Delbruck 2021); 50 to 100 IEBCS; DAVIS346 street 1000",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.period_us > 0

    def prepare(self, sensor: Sensor) -> None:
        sensor.refractory_us = self.period_us
