"""Light that reaches the reset switch itself: the drift term in L of Eq. 10."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..kernel import kernel


class ParasiticPhotocurrent(Effect):
    """Drift k5 L."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "ON events at rest, at a rate in proportion to brightness"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    k5_per_dn_us: float = quantity(
        5e-9, unit="1/(DN us)", ge=0, le=1, meaning="leak for each grey level of brightness",
        source="DVS-Voltmeter (ECCV 2022), DAVIS346 set; mechanism: Nozaki and Delbruck (2017)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.k5_per_dn_us > 0

    def drift(self, band: Band) -> None:
        half = np.float32(0.5 * self.k5_per_dn_us * band.span_us)
        band.apply(add_in_proportion, band.light_before, band.light, half, band.drift)


@kernel
def add_in_proportion(first: Any, last: Any, half: Any, drift: Any) -> None:
    for i in range(drift.shape[0]):
        drift[i] += half * (first[i] + last[i])
