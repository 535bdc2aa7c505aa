"""No two comparators are alike."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, Sensor, quantity

LOWEST = 0.1
"""A threshold is never less than this share of its mean: it stays positive."""


class ThresholdMismatch(Effect):
    """theta (1 + sigma xi), xi normal and fixed, for each pixel and each of its two thresholds on its own."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "the same pixels always give more events than others, ON or OFF, for the same motion"
    )
    steady: ClassVar[bool] = True

    sigma: float = quantity(
        0.0, unit="1", ge=0, le=0.5, meaning="spread of the thresholds relative to their mean",
        source="v2e (Hu, Liu, Delbruck 2021): 0.03 e-folds of 0.2 is 0.15, noisy 0.25; IEBCS: 0.025 to 0.17",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.sigma > 0

    def prepare(self, sensor: Sensor) -> None:
        rng = sensor.pattern(self.name)
        for theta in (sensor.theta_on, sensor.theta_off):
            theta *= np.maximum(1 + self.sigma * rng.standard_normal(theta.shape), LOWEST)
