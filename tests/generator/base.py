"""The published model's parameters, and how far off a camera of ours is from them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# DVS-Voltmeter (ECCV 2022), its published sets; k1, k2 [DN], k3, k4 [1/us], k5 [1/(DN us)], k6 [1/sqrt(us)]
PUBLISHED = {
    "davis346": (5.265, 20.0, 1e-4, 1e-7, 5e-9, 1e-5),
    "davis240c": (4.42411, 23.0, 2e-4, 1e-7, 5e-8, 1e-5),
}


@dataclass(frozen=True)
class Base:
    camera: str  # the published set it was drawn around
    k1: float
    k2: float
    k3: float
    k4: float
    k5: float
    k6: float
    theta_on: float = 1.0
    theta_off: float = 1.0

    def leak(self, light: Floats) -> Floats:
        """1/us, without the junction's k4."""
        return self.k5 * light

    def sigma(self, light: Floats) -> Floats:
        """1/sqrt(us)"""
        return self.k3 * np.sqrt(light) / (light + self.k2) + self.k6


def draw_base(
    rng: np.random.Generator, off_by: float = 0.3, asymmetry: float | None = None, camera: str | None = None
) -> Base:
    """Each k off by a factor log-uniform in 1/(1+off_by)..1+off_by, theta_on/theta_off likewise by asymmetry
    (None: off_by), their product 1. camera: a published set, None: the DAVIS346 two times in three."""
    camera = camera or str(rng.choice(["davis346", "davis346", "davis240c"]))
    width = np.log1p(off_by)
    k = np.array(PUBLISHED[camera]) * np.exp(rng.uniform(-width, width, 6))
    ratio = np.exp(rng.uniform(-1, 1) * np.log1p(off_by if asymmetry is None else asymmetry))
    return Base(camera, *map(float, [*k, np.sqrt(ratio), 1 / np.sqrt(ratio)]))
