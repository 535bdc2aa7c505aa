"""Noise that is there at any brightness: the constant term of Eq. 11."""

from typing import ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..plane_kernels import add


class LeakNoise(Effect):
    """Noise k6, of the leak current and the circuit."""

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "spread of the intervals between leak events"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    k6: float = quantity(
        1e-5, unit="1/sqrt(us)", ge=0, le=1, meaning="noise at any brightness",
        source="DVS-Voltmeter (ECCV 2022), DAVIS346 and DAVIS240C sets",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.k6 > 0

    def drift(self, band: Band) -> None:
        band.apply(add, band.noise, np.float32(self.k6))
