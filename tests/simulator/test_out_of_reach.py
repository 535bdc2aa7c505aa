"""Pixels whose thresholds are out of reach: drift and variance add up, nothing is drawn."""

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Plane
from voltcam_simulator.groups import Motion, Pixels
from voltcam_simulator.out_of_reach import accumulate

N, SPAN_US = 5000, 1000.0
Moving = tuple[Pixels, Motion, NDArray[np.bool_]]


def moving(bow: Plane | float) -> Moving:
    """Pixels that go their ways, beyond the ends by their bows; and which are far, by the rule."""
    rng = np.random.default_rng(5)
    voltage = rng.uniform(-1, 1, N).astype(np.float32)
    pending = rng.uniform(0, 0.03, N).astype(np.float32)
    drift = rng.normal(0, 0.3, N).astype(np.float32)
    noise = rng.uniform(0, 1e-3, N).astype(np.float32)
    above, below = (rng.uniform(0.8, 1.2, N).astype(np.float32) for _ in range(2))
    held = (rng.random(N) < 0.01).astype(np.float32)
    variance = pending + noise * noise * np.float32(SPAN_US)
    highest = np.maximum(voltage, voltage + drift) + np.maximum(bow, 0)
    lowest = np.minimum(voltage, voltage + drift) + np.minimum(bow, 0)
    distance = np.minimum(above - highest, below + lowest)
    far = (distance > 7.4 * np.sqrt(variance)) & (held == 0)
    return Pixels(voltage, pending, held, above, below), Motion(drift, noise), far


def check(pixels: Pixels, motion: Motion, far: NDArray[np.bool_], before: Pixels) -> None:
    """Far pixels have moved, the others stand where they stood."""
    variance = before.pending + motion.noise**2 * np.float32(SPAN_US)
    voltage = np.where(far, before.voltage + motion.drift, before.voltage)
    np.testing.assert_allclose(pixels.voltage, voltage, rtol=1e-6)
    np.testing.assert_allclose(pixels.pending, np.where(far, variance, before.pending), rtol=1e-6)


def run(pixels: Pixels, motion: Motion, bow: Plane | None) -> tuple[list[int], list[int]]:
    near, bent = np.empty((2, N + 1), np.int32)
    straight, curved = accumulate(*pixels, *motion, bow, SPAN_US, N, np.zeros(1, np.bool_), near, bent)
    return near[:straight].tolist(), bent[:curved].tolist()


def test_accumulate_is_its_numpy_twin() -> None:
    pixels, motion, far = moving(0.0)
    before = Pixels(*(plane.copy() for plane in pixels))
    near, bent = run(pixels, motion, None)
    assert 0 < len(near) < N
    assert near == np.flatnonzero(~far).tolist()
    assert bent == []
    check(pixels, motion, far, before)


def test_a_bent_path_goes_beyond_its_ends_by_its_bow() -> None:
    """Straight is what is 0.01 thresholds off at most, or what the voltage does in half a millisecond."""
    bow = np.random.default_rng(6).normal(0, 0.1, N).astype(np.float32)
    pixels, motion, far = moving(bow)
    before = Pixels(*(plane.copy() for plane in pixels))
    straight = np.abs(bow) <= np.maximum(0.01, 0.5 * np.abs(motion.drift))
    assert 0.1 < straight.mean() < 0.9
    near, bent = run(pixels, motion, bow)
    assert near == np.flatnonzero(~far & straight).tolist()
    assert bent == np.flatnonzero(~far & ~straight).tolist()
    assert min(len(near), len(bent)) > 100
    check(pixels, motion, far, before)
