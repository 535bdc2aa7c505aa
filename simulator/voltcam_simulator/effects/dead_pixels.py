"""Pixels that never speak."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, Sensor, quantity


class DeadPixels(Effect):
    """A fixed share of the pixels has thresholds out of reach."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "pixels without any event where their neighbours have many"
    steady: ClassVar[bool] = True

    fraction: float = quantity(
        0.0, unit="1", ge=0, le=1, meaning="share of the pixels", source="0 to 0.001 (assumed)"
    )

    @property
    def active(self) -> bool:
        return self.fraction > 0

    def prepare(self, sensor: Sensor) -> None:
        dead = sensor.pattern(self.name).random((sensor.height, sensor.width)) < self.fraction
        sensor.theta_on[dead] = sensor.theta_off[dead] = np.inf
