r"""Photons are few in the dark: noise events of both polarities."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..kernel import kernel


class LowLightShotNoise(Effect):
    r"""Independent noise sigma^2 = c^2/(L + dark_dn)^2.

    Brownian motion from 0 leaves (-theta_off, theta_on) after 1/rate = theta_off theta_on/sigma^2 on average,
    and at the top in a share theta_off/(theta_on + theta_off) of cases. So, with unit thresholds, ON and OFF
    together at 5 Hz in full darkness (v2e, "noisy") need sigma^2 = 5e-6/us: c = 0.00224 dark_dn, 0.0112 at
    5 DN. 5.0 ON and 3.7 OFF Hz (measured at 0.1 lux, IEBCS) need theta_off/theta_on = 5.0/3.7 = 1.35, that
    is 0.86 and 1.16, and sigma^2 = 8.7e-6/us: c = 0.0147 at 5 DN. (With equal thresholds: a leak of 1.3 per
    second and sigma^2 = 8.6e-6/us, from ON - OFF = mu and (ON - OFF)/(ON + OFF) = tanh(mu/sigma^2).)
    """

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = "ON and OFF events of single pixels in the dark, at rest"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    c: float = quantity(
        0.0, unit="DN/sqrt(us)", ge=0, le=10, meaning="noise in thresholds, times brightness",
        source="0.0112: 5 Hz, v2e (Hu, Liu, Delbruck 2021); 0.0147: 8.7 Hz, IEBCS (Joubert et al. 2021)",
    )  # fmt: skip
    dark_dn: float = quantity(
        5.0, unit="DN", gt=0, le=1000, meaning="brightness below which the noise grows no more",
        source="a quarter of k2 (assumed): dim means darker than that",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.c > 0

    def drift(self, band: Band) -> None:
        c, dark = np.float32(self.c), np.float32(self.dark_dn)
        band.apply(add_shot_noise, band.light_before, band.light, c, dark, band.independent_noise())


@kernel
def add_shot_noise(first: Any, last: Any, c: Any, dark: Any, noise2: Any) -> None:
    half = np.float32(0.5)
    for i in range(noise2.shape[0]):
        sigma = c / (half * (first[i] + last[i]) + dark)
        noise2[i] += sigma * sigma
