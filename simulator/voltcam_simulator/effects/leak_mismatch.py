"""Every reset switch leaks at its own rate."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, Sensor, quantity


class LeakMismatch(Effect):
    """Junction leak times exp(sigma xi - sigma^2/2), xi normal and fixed: log-normal, of mean 1."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "the same pixels always give more ON events at rest than others"
    steady: ClassVar[bool] = True

    sigma: float = quantity(
        0.0, unit="1", ge=0, le=3, meaning="spread of the logarithm of the leak",
        source="0.23: a tenth of a decade, v2e (Hu, Liu, Delbruck 2021)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.sigma > 0

    def prepare(self, sensor: Sensor) -> None:
        xi = sensor.pattern(self.name).standard_normal((sensor.height, sensor.width))
        sensor.leak = np.exp(self.sigma * xi - 0.5 * self.sigma**2).astype(np.float32)
