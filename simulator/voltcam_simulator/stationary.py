"""Where the voltage of a pixel stands that has been looking at a still scene for long."""

import math
from typing import Any

import numpy as np

from .kernel import kernel
from .random import sequence, uniform

LONG_US = 60e6
"""What a scene has been still for: a camera that has just been put somewhere."""


@kernel
def start_voltage(pixels: Any, motion: Any, key: Any, first_pixel: Any) -> None:
    """Voltages of pixels that have been looking at a still scene for long: the stationary law.

    motion: the `Motion` of the still scene over a microsecond; key: `interval_key`. With nu = 2 mu / sigma^2
    the density of a Brownian motion that restarts at 0 when it leaves (-B, A) is, up to its height at 0,

        (1 - exp(-nu (A - x))) / (1 - exp(-nu A))             for x >= 0
        (exp(nu x) - exp(-nu B)) / (1 - exp(-nu B))           for x < 0

    (Green's function of the generator: the tent for nu = 0, uniform on (0, A) for pure drift). Starting
    there, a still scene gives its long-run event rate from the first microsecond on, and not a burst of
    leak events after 1/mu. Drawn by rejection from the uniform law.

    A drift that does not cross the band within LONG_US has made the law its own in that share of the pixels
    only. The others have the tent, which motion before has left.
    """
    voltage, above, below, drift, noise = (
        pixels.voltage, pixels.above, pixels.below, motion.drift, motion.noise
    )  # fmt: skip
    for i in range(voltage.shape[0]):
        if above[i] + below[i] == np.inf:
            continue  # a dead pixel: it has no band
        state = sequence(key, first_pixel + i)
        mu, sigma = np.float64(drift[i]), np.float64(noise[i])
        side = 1.0 if mu >= 0.0 else -1.0
        a, b = (above[i], below[i]) if mu >= 0.0 else (below[i], above[i])
        nu = 0.0 if mu == 0.0 else (2.0 * abs(mu) / (sigma * sigma) if sigma > 0.0 else math.inf)
        crossed = abs(mu) * LONG_US / a
        if crossed < 1.0:
            state, u = uniform(state)
            nu = nu if u < crossed else 0.0
        while True:
            state, place = uniform(state)
            state, u = uniform(state)
            x = place * (a + b) - b
            if u < stationary_density(x, nu, a, b):
                break
        voltage[i] = side * x


@kernel
def stationary_density(x: Any, nu: Any, a: Any, b: Any) -> Any:
    """The stationary density at x relative to its value at 0, for nu >= 0 (inf: no noise)."""
    if x >= 0.0:
        if nu * a > 700.0:
            return 1.0 - math.exp(-nu * (a - x)) if nu < math.inf else 1.0
        return math.expm1(-nu * (a - x)) / math.expm1(-nu * a) if nu * a > 1e-12 else (a - x) / a
    if nu * b > 700.0:
        return math.exp(nu * x) if nu < math.inf else 0.0
    if nu * b > 1e-12:
        return (math.exp(nu * x) - math.exp(-nu * b)) / -math.expm1(-nu * b)
    return (x + b) / b
