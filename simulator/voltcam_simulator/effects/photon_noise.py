"""Shot noise of the photocurrent, the first noise term of Eq. 11."""

import math
from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..kernel import kernel


class PhotonNoise(Effect):
    """Noise k3 sqrt(L)/(L + k2), Poisson photons seen through the logarithm; k2: `contrast_response`."""

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "jitter of event times, and ON and OFF noise events, most at L = k2"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    k3: float = quantity(
        1e-4, unit="sqrt(DN)/sqrt(us)", ge=0, le=1, meaning="photon noise",
        source="DVS-Voltmeter (ECCV 2022), DAVIS346 set",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.k3 > 0

    def drift(self, band: Band) -> None:
        k2 = np.float32(band.sensor.dark_level_dn)
        band.apply(add_photon_noise, band.light_before, band.light, np.float32(self.k3), k2, band.noise)


@kernel
def add_photon_noise(first: Any, last: Any, k3: Any, k2: Any, noise: Any) -> None:
    half = np.float32(0.5)
    for i in range(noise.shape[0]):
        level = half * (first[i] + last[i])
        noise[i] += k3 * math.sqrt(level) / (level + k2)
