"""A noise nobody has a name for, as a diagnosis finds it."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..kernel import kernel
from .residual_drift import powered


class ResidualNoise(Effect):
    """Independent noise sigma^2 = variance_per_us ((L + dark_dn)/(128 + dark_dn))^power: what is left to say
    of a noise whose mechanism is unknown.
    """

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "wider intervals, or ON and OFF events at rest, that no known noise gives"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    variance_per_us: float = quantity(
        0.0, unit="1/us", ge=0, le=1, meaning="sigma^2 at 128 DN",
        source="found by voltcam diagnose; the paper's noise of a DAVIS346 there is 3.1e-10",
    )  # fmt: skip
    power: float = quantity(
        0.0, unit="1", ge=-4, le=4, meaning="how it goes with brightness",
        source="found by voltcam diagnose",
    )  # fmt: skip
    dark_dn: float = quantity(
        20.0, unit="DN", gt=0, le=1000, meaning="added to the brightness", source="as k2 (assumed)"
    )

    @property
    def active(self) -> bool:
        return self.variance_per_us > 0

    def drift(self, band: Band) -> None:
        band.apply(
            add_power2, band.light_before, band.light, self.variance_per_us, self.power, self.dark_dn,
            band.independent_noise(),
        )  # fmt: skip


@kernel
def add_power2(first: Any, last: Any, size: Any, power: Any, dark: Any, noise2: Any) -> None:
    for i in range(noise2.shape[0]):
        noise2[i] += np.float32(size * powered(first[i], last[i], power, dark))
