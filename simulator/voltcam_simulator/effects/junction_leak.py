"""Leak of the reset switch's junction: the constant drift term of Eq. 10, with its temperature (Eq. 4)."""

import math
from typing import ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..plane_kernels import add, add_product

BOLTZMANN_EV_PER_K = 8.617333262e-5
ZERO_C_IN_K = 273.15
REFERENCE_C = 25.0
"""Temperature at which k4 is given."""


def arrhenius(temperature_c: float, activation_energy_ev: float) -> float:
    """exp(-Ea/kB (1/T - 1/Tref)): the leak relative to the reference temperature (Eq. 4)."""
    inverse = 1.0 / (temperature_c + ZERO_C_IN_K) - 1.0 / (REFERENCE_C + ZERO_C_IN_K)
    return math.exp(-activation_energy_ev / BOLTZMANN_EV_PER_K * inverse)


class JunctionLeak(Effect):
    """Drift k4, scaled by Arrhenius' law with the camera's temperature."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "ON events at rest, at a rate that is the same at all brightnesses"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    k4_per_us: float = quantity(
        1e-7, unit="1/us", ge=0, le=1, meaning="leak at 25 C; 1e-7 is one ON event in 10 s",
        source="DVS-Voltmeter (ECCV 2022), DAVIS346 and DAVIS240C sets",
    )  # fmt: skip
    activation_energy_ev: float = quantity(
        0.56, unit="eV", ge=0, le=2, meaning="how steeply the leak rises with temperature",
        source="half the band gap of silicon: depletion regions, Widenhorn et al., SPIE 4669 (2002)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.k4_per_us > 0

    def drift(self, band: Band) -> None:
        rate = self.k4_per_us * arrhenius(band.temperature_c, self.activation_energy_ev)
        voltage = np.float32(rate * band.span_us)
        if band.leak is None:
            band.apply(add, band.drift, voltage)
        else:
            band.apply(add_product, band.drift, voltage, band.leak)
