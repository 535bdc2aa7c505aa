"""An IMU at rest: times, gravity, noise of the data sheet, the temperature of the die."""

import itertools

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import ImuAtRest
from voltcam_simulator.imu import ACCEL_NOISE_G, GYRO_NOISE_DEG_S

RATE_HZ = 1000.0
LEVEL = 1e-6  # of a false alarm, for each test


def test_it_is_the_same_however_time_is_cut() -> None:
    imu = ImuAtRest(RATE_HZ, seed=5)
    whole = imu.samples(0, 1_000_000, 25)
    inner = np.sort(np.random.default_rng(1).choice(np.arange(1, 1_000_000), 99, replace=False))
    cuts = [0, *inner.tolist(), 1_000_000]
    pieces = [imu.samples(a, b, 25) for a, b in itertools.pairwise(cuts)]
    for name in whole._fields:
        np.testing.assert_array_equal(
            np.concatenate([getattr(piece, name) for piece in pieces]), getattr(whole, name)
        )


@pytest.mark.parametrize("rate_hz", [1.0, 997.0, 1000.0, 8000.0])
def test_its_rate(rate_hz: float) -> None:
    t_us = ImuAtRest(rate_hz, seed=5).samples(1_700_000_000_000_000, 1_700_000_003_000_000, 25).t_us
    assert t_us.size == 3 * rate_hz
    assert np.abs(np.diff(t_us) - 1e6 / rate_hz).max(initial=0) <= 1


def test_noise_and_gravity() -> None:
    """Variances by the chi-square law, means by the normal one."""
    samples = ImuAtRest(RATE_HZ, seed=5).samples(0, 100_000_000, 25)
    n, bandwidth = samples.t_us.size, RATE_HZ / 2
    low, high = stats.chi2.ppf([LEVEL / 12, 1 - LEVEL / 12], n - 1) / (n - 1)
    sides = [
        (samples.accel_g - (0, -1, 0), ACCEL_NOISE_G * bandwidth**0.5),
        (samples.gyro_deg_s, GYRO_NOISE_DEG_S * bandwidth**0.5),
    ]
    for values, sigma in sides:
        assert (np.abs(values.mean(0)) < stats.norm.isf(LEVEL / 12) * sigma / n**0.5).all()
        assert ((low < values.var(0) / sigma**2) & (values.var(0) / sigma**2 < high)).all()
    both = np.concatenate([samples.accel_g, samples.gyro_deg_s], axis=1)
    others = np.corrcoef(both.T)[np.triu_indices(6, 1)]
    assert (np.abs(others) < stats.norm.isf(LEVEL / 30) / n**0.5).all()


def test_the_temperature_is_that_of_the_die() -> None:
    imu = ImuAtRest(RATE_HZ, seed=5)
    for temperature_c in (-40.0, 25.0, 85.5):
        told = imu.samples(0, 10_000, temperature_c).temperature_c
        assert np.abs(told - temperature_c).max() < 0.5 / 333


def test_other_seeds_are_other_units() -> None:
    first, second = (ImuAtRest(RATE_HZ, seed).samples(0, 10_000, 25) for seed in (1, 2))
    assert (first.gyro_deg_s != second.gyro_deg_s).all()
