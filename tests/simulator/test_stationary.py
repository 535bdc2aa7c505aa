"""Where the voltages start: the stationary law of a still scene."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats
from scipy.integrate import cumulative_trapezoid

from voltcam_simulator.groups import Motion, Pixels
from voltcam_simulator.random import START, interval_key
from voltcam_simulator.stationary import start_voltage, stationary_density

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


@pytest.mark.parametrize("nu", [0.0, 1e-14, 0.3, 4.0, 2000.0])
def test_the_density_is_the_flux_balanced_solution(nu: float) -> None:
    """Away from 0 the flux nu f - f' is the same everywhere; f is 1 at 0 and 0 at both thresholds."""
    a, b = 1.3, 0.7
    x = np.linspace(-b, a, 41)
    y = x.astype(np.longdouble)
    if nu < 1e-9:
        expected = np.where(x >= 0, (a - y) / a, (y + b) / b)
    else:
        expected = np.where(
            x >= 0,
            np.expm1(-nu * (a - y)) / np.expm1(np.longdouble(-nu * a)),
            np.exp(nu * np.minimum(y, 0)) * np.expm1(-nu * (y + b)) / np.expm1(np.longdouble(-nu * b)),
        )
    found = [stationary_density(float(place), nu, a, b) for place in x]
    np.testing.assert_allclose(found, expected.astype(float), rtol=1e-9, atol=1e-12)


def test_without_noise_the_density_is_uniform_on_the_way_to_the_threshold() -> None:
    assert [stationary_density(x, math.inf, 1.0, 1.0) for x in (-0.5, 0.0, 0.999)] == [0, 1, 1]


@pytest.mark.parametrize(("drift", "noise"), [(1.0, 0.5), (-1.0, 0.5), (0.0, 1.0), (-1.0, 0.0)])
def test_voltages_are_drawn_from_the_density(drift: float, noise: float) -> None:
    """Against its integral; a drift down mirrors the band."""
    above, below, n = 0.7, 1.3, 8000
    pixels = Pixels(*(np.full(n, v, np.float32) for v in (0, 0, 0, above, below)))
    motion = Motion(*(np.full(n, v, np.float32) for v in (drift / 1e6, noise / 1e3)))
    start_voltage(pixels, motion, interval_key(4, START, 0), 0)
    a, b = (above, below) if drift >= 0 else (below, above)
    nu = 2 * abs(drift) / noise**2 if noise else math.inf
    grid = np.linspace(-b, a, 4001)
    cdf = cumulative_trapezoid([stationary_density(x, nu, a, b) for x in grid], grid, initial=0)
    towards = pixels.voltage * (1 if drift >= 0 else -1)
    assert stats.kstest(towards, lambda v: np.interp(v, grid, cdf / cdf[-1])).pvalue > P_LIMIT


def test_a_dead_pixel_keeps_its_voltage_and_a_pixel_starts_by_its_number() -> None:
    def start(first_pixel: int, count: int) -> NDArray[np.float32]:
        above = np.full(count, 1, np.float32)
        above[0] = np.inf
        pixels = Pixels(np.full(count, 9, np.float32), above, above, above, np.full(count, 1, np.float32))
        motion = Motion(*(np.full(count, v, np.float32) for v in (1e-6, 1e-4)))
        start_voltage(pixels, motion, interval_key(4, START, 0), first_pixel)
        return pixels.voltage

    whole, part = start(0, 20), start(5, 15)
    assert whole[0] == part[0] == 9
    assert (np.abs(whole[1:]) < 1).all()
    np.testing.assert_array_equal(whole[6:], part[1:])


def test_a_drift_too_slow_to_cross_the_band_leaves_what_motion_left() -> None:
    """A tenth of a threshold a minute: a tenth of the pixels have its uniform law, the others the tent."""
    n, drift = 8000, np.float32(0.1 / 60e6)
    pixels = Pixels(*(np.full(n, v, np.float32) for v in (0, 0, 0, 1, 1)))
    start_voltage(pixels, Motion(np.full(n, drift), np.zeros(n, np.float32)), interval_key(4, START, 0), 0)

    def law(v: NDArray[np.float64]) -> NDArray[np.float64]:
        tent = np.where(v < 0, (1 + v) ** 2 / 2, 1 - (1 - v) ** 2 / 2)
        return np.asarray(0.9 * tent + 0.1 * np.clip(v, 0, 1))

    assert stats.kstest(pixels.voltage, law).pvalue > P_LIMIT
