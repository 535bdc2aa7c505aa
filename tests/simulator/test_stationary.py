"""Where the voltages start: the stationary law of a still scene."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator.groups import Motion, Pixels
from voltcam_simulator.random import START, interval_key
from voltcam_simulator.stationary import start_voltage

P_LIMIT = 1e-4  # chance that a correct sampler would fail one assertion for a random seed


@pytest.mark.parametrize(
    ("drift", "noise", "above", "below"),
    [
        (1.0, 0.0, 1.0, 1.0),
        (1.0, 0.02, 1.0, 1.0),
        (-1.0, 0.5, 1.0, 0.6),
        (0.0, 1.0, 0.7, 1.3),
        (0.4, 1.0, 1, 1),
    ],
)
def test_the_start_is_the_stationary_law(drift: float, noise: float, above: float, below: float) -> None:
    """Evolving the start for a while must give the same law back (the definition of stationary)."""
    n = 8000

    def start(seed: int) -> NDArray[np.float32]:
        pixels = Pixels(*(np.full(n, v, np.float32) for v in (0, 0, 0, above, below)))
        motion = Motion(*(np.full(n, v, np.float32) for v in (drift / 1e6, noise / 1e3)))
        start_voltage(pixels, motion, interval_key(seed, START, 0), 0)
        return pixels.voltage

    voltage = start(1)
    assert (voltage < above).all()
    assert (voltage > -below).all()
    later = voltage.astype(np.float64)
    rng = np.random.default_rng(3)
    steps = 2000
    inwards = 0.5826 * noise / np.sqrt(steps)
    for _ in range(steps):
        later += drift / steps + noise / np.sqrt(steps) * rng.standard_normal(n)
        later[later >= above - inwards] -= above
        later[later <= inwards - below] += below
    assert stats.ks_2samp(start(2), later).pvalue > P_LIMIT
