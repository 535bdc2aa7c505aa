"""The pixel answers to relative change: the term in dL/dt of Eq. 10."""

from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from ..effect import About, Band, Effect, quantity
from ..kernel import kernel
from ..logarithm import logarithm


class ContrastResponse(Effect):
    """Response k1 ln(F + k2), or the drift of its linearisation, k1 (F1 - F0)/(L + k2) with L the mean.

    The logarithm (Eq. 1) adds up to the same however a change is cut into frames: 0 to 255 DN is 2.62 k1 on a
    DAVIS346, where the linearisation of Eq. 10 gives 1.73 k1 in one frame.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "events at moving edges, in proportion to the change of log brightness"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    k1: float = quantity(
        5.265, unit="1", ge=0, le=1000, meaning="contrast gain, in thresholds per e-fold of brightness",
        source="DVS-Voltmeter (ECCV 2022), DAVIS346 set",
    )  # fmt: skip
    k2_dn: float = quantity(
        20.0, unit="DN", gt=0, le=10_000, meaning="dark level added to the grey value",
        source="DVS-Voltmeter (ECCV 2022), DAVIS346 set",
    )  # fmt: skip
    response: Literal["logarithmic", "linearised"] = Field(
        "logarithmic", description="exact logarithm, or the paper's linearisation (always, with law paper)"
    )

    @property
    def active(self) -> bool:
        return self.k1 > 0

    def respond(self, band: Band) -> None:
        if self.response == "logarithmic":
            k1, k2 = np.float32(self.k1), np.float32(self.k2_dn)
            band.apply(add_logarithmic, band.light, k1, k2, band.response)

    def drift(self, band: Band) -> None:
        if self.response == "linearised":
            k1, k2 = np.float32(self.k1), np.float32(self.k2_dn)
            band.apply(add_linearised, band.light_before, band.light, k1, k2, band.drift)


@kernel
def add_logarithmic(light: Any, k1: Any, k2: Any, response: Any) -> None:
    for i in range(light.shape[0]):
        response[i] += k1 * logarithm(light[i] + k2)


@kernel
def add_linearised(first: Any, last: Any, k1: Any, k2: Any, drift: Any) -> None:
    half = np.float32(0.5)
    for i in range(drift.shape[0]):
        drift[i] += k1 * (last[i] - first[i]) / (half * (first[i] + last[i]) + k2)
