"""Pixels whose thresholds are out of reach: drift and variance add up, nothing is drawn."""

import numpy as np

from voltcam_simulator.groups import Motion, Pixels
from voltcam_simulator.out_of_reach import accumulate


def test_accumulate_is_its_numpy_twin() -> None:
    rng = np.random.default_rng(5)
    n = 5000
    voltage = rng.uniform(-1, 1, n).astype(np.float32)
    pending = rng.uniform(0, 0.03, n).astype(np.float32)
    drift = rng.normal(0, 0.3, n).astype(np.float32)
    noise = rng.uniform(0, 1e-3, n).astype(np.float32)
    above, below = (rng.uniform(0.8, 1.2, n).astype(np.float32) for _ in range(2))
    variance = pending + noise * noise * np.float32(1000)
    distance = np.minimum(
        above - np.maximum(voltage, voltage + drift), below + np.minimum(voltage, voltage + drift)
    )
    far = distance > 7.4 * np.sqrt(variance)
    near, held = np.empty(n + 1, np.int32), (rng.random(n) < 0.01).astype(np.float32)
    far &= held == 0
    expected = np.where(far, voltage + drift, voltage), np.where(far, variance, pending)
    pixels, motion = Pixels(voltage, pending, held, above, below), Motion(drift, noise)
    count = accumulate(*pixels, *motion, 1000.0, n, np.zeros(1, np.bool_), near)
    assert 0 < count < n
    assert near[:count].tolist() == np.flatnonzero(~far).tolist()
    np.testing.assert_allclose(voltage, expected[0], rtol=1e-6)
    np.testing.assert_allclose(pending, expected[1], rtol=1e-6)
