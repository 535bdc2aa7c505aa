"""Current of the photodiode without light."""

from typing import ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..plane_kernels import add
from .input_response import MOST_LIGHT_DN
from .junction_leak import REFERENCE_C


class DarkCurrent(Effect):
    """dark_dn more light on every pixel, twice as much for each doubling_c degrees above 25 C.

    It comes on top of k2, which is fixed: the dark current of the camera when k2 was fitted is in there.
    It is 1e6 DN at most.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "less contrast in the dark, the more so the warmer: fewer events from dim edges"
    )
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    dark_dn: float = quantity(
        0.0, unit="DN", ge=0, le=10_000, meaning="dark current at 25 C, as the light that would give it",
        source="to be fitted: k2 (20 and 23 DN, DVS-Voltmeter) holds that of its calibration",
    )  # fmt: skip
    doubling_c: float = quantity(
        8.0, unit="C", ge=1, le=100, meaning="warming that doubles it",
        source="5 to 8 C, silicon imagers (Theuwissen, harvestimaging.com, 2009)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.dark_dn > 0

    def see(self, band: Band) -> None:
        doublings = (band.temperature_c - REFERENCE_C) / self.doubling_c
        band.apply(add, band.light, np.float32(min(self.dark_dn * 2**doublings, MOST_LIGHT_DN)))
