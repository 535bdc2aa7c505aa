"""The reset switch does not leave the voltage exactly at 0."""

from typing import ClassVar

from ..effect import About, Effect, Sensor, quantity


class ResetNoise(Effect):
    """The voltage after an event is normal with spread sigma, held inside nine tenths of the thresholds."""

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "intervals spread about their mean, anew at each event and not by pixel"

    sigma: float = quantity(
        0.0, unit="nominal thresholds", ge=0, le=0.5, meaning="spread of the voltage after a reset",
        source="IEBCS (Joubert et al. 2021): 0.01 to 0.05 e-folds of 0.3 to 0.4: 0.025 to 0.17",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.sigma > 0

    def prepare(self, sensor: Sensor) -> None:
        sensor.reset_sigma = self.sigma
