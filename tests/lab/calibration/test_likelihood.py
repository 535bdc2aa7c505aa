"""The likelihood of intervals against closed forms and a slow integral."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import invgauss

from voltcam_lab.calibration.intervals import INTERVAL
from voltcam_lab.calibration.likelihood import START, Likelihood

SURE = START | {
    "threshold_spread": 1e-7, "leak_spread": 1e-7, "reset_spread": 1e-9,
    "k4_per_us": 1e-7, "k5_per_dn_us": 5e-9, "k6": 1e-4,
}  # fmt: skip
LIGHT = 100.0
SPREAD = 0.05
LEAK = 1e-7 + 5e-9 * LIGHT
SIGMA = 1e-4 * np.sqrt(LIGHT) / (LIGHT + 20) + 1e-4


def at_rest(lengths_us: np.ndarray, end: int = 1) -> np.ndarray:
    """Intervals of light that stands still, each of a pixel of its own."""
    seen = np.zeros(len(lengths_us), INTERVAL)
    seen["pixel"], seen["end_us"], seen["end"], seen["start"] = np.arange(len(seen)), lengths_us, end, 1
    for name in ("before", "after", "mean", "lowest", "highest"):
        seen[name] = LIGHT
    return seen


def test_a_straight_path_has_the_inverse_gaussian_law() -> None:
    t_us = np.linspace(4e5, 5e6, 200)
    found = Likelihood(at_rest(t_us), 0.0).parts(SURE)
    mean, shape = 1 / LEAK, 1 / SIGMA**2
    assert found == pytest.approx(invgauss.logpdf(t_us, mean / shape, scale=shape), abs=0.011)  # OUTLIER


def test_the_density_of_either_end_integrates_to_one() -> None:
    t_us = np.linspace(1e3, 8e6, 20_000)
    on = np.exp(Likelihood(at_rest(t_us), 0.0).parts(SURE))
    assert np.trapezoid(on, t_us) == pytest.approx(1, abs=0.011)


def test_what_is_not_seen_to_end_has_the_rest_of_it() -> None:
    t_us = np.array([8e5, 1.2e6, 1.6e6])
    calm = SURE | {"k6": 1e-5}
    sigma = 1e-4 * np.sqrt(LIGHT) / (LIGHT + 20) + 1e-5
    alive = np.exp(Likelihood(at_rest(t_us, end=0), 0.0).parts(calm))
    law = invgauss(sigma**2 / LEAK, scale=1 / sigma**2)
    assert alive == pytest.approx(0.99 * law.sf(t_us) + 0.01, abs=0.01)


def test_light_that_rises_leads_to_on_and_falls_to_off() -> None:
    seen = at_rest(np.array([50_000.0, 50_000.0]))
    seen["after"], seen["highest"], seen["slope"] = 125, 125, 5e-4
    seen["end"] = [1, -1]
    up, down = Likelihood(seen, 0.0).parts(SURE)
    assert up > down + 10


def summed(t_us: np.ndarray, density: Callable[[np.ndarray], np.ndarray]) -> tuple[np.ndarray, float]:
    """Intervals of one pixel, and the log of their density (intervals, values), which depends on a value that
    the pixel keeps and that is normal with SPREAD: a sum over it."""
    seen, value = at_rest(t_us), np.linspace(-6, 6, 4001) * SPREAD
    seen["pixel"] = 0
    own = np.exp(-0.5 * (value / SPREAD) ** 2) / np.sqrt(2 * np.pi) / SPREAD
    return seen, float(np.log(np.trapezoid(np.prod(density(value), axis=0) * own, value)))


def test_what_a_pixel_keeps_is_integrated_over() -> None:
    """Three intervals of one pixel, whose threshold differs from the others'."""
    t_us = np.array([1.5e6, 1.6e6, 1.75e6])
    variance = SIGMA**2 * t_us
    x = 1 - LEAK * t_us
    speed = LEAK + SIGMA**2 * x / variance

    def density(shift: np.ndarray) -> np.ndarray:
        normal = np.exp(-0.5 * (x[:, None] - shift) ** 2 / variance[:, None])
        return normal * (speed / np.sqrt(2 * np.pi * variance))[:, None]

    seen, slow = summed(t_us, density)
    (found,) = Likelihood(seen, 0.0).parts(SURE | {"threshold_spread": SPREAD})
    assert found == pytest.approx(slow, abs=0.06)  # its speed has the likeliest threshold's instead of each


def test_a_pixels_own_leak_counts_in_its_speed() -> None:
    """As above, with a leak that differs: what leaks less takes longer over each stretch."""
    t_us = np.array([1.8e6, 1.9e6, 2.0e6])
    t = t_us[:, None]

    def density(less: np.ndarray) -> np.ndarray:
        x = 1 - LEAK * (1 - less) * t
        return np.exp(-0.5 * x**2 / (SIGMA**2 * t)) / np.sqrt(2 * np.pi * SIGMA**2 * t**3)

    seen, slow = summed(t_us, density)
    (found,) = Likelihood(seen, 0.0).parts(SURE | {"leak_spread": SPREAD})
    assert found == pytest.approx(slow, abs=0.06)


def test_a_pixel_without_threshold_and_leak_explains_nothing() -> None:
    """With both at 0, any interval would fit exactly: intervals that differ must stay noise."""
    t_us = (1 + 0.01 * np.random.default_rng(0).standard_normal(2000)) / LEAK
    seen = at_rest(t_us)
    seen["pixel"] //= 20
    likelihood = Likelihood(seen, 0.0)
    alike = SURE | {"k3": 1e-9, "k6": 0.01 * LEAK**0.5}
    odd = SURE | {"k3": 1e-9, "k6": 1e-7, "threshold_spread": 0.5, "leak_spread": 0.5}
    assert likelihood.parts(odd).sum() < likelihood.parts(alike).sum()


def test_stray_events_lose_their_weight() -> None:
    lengths = np.concatenate([np.full(200, 1 / LEAK), np.full(10, 1000.0)])
    likelihood = Likelihood(at_rest(lengths), 0.0)
    likelihood.stray_per_us[:] = 1e-9
    likelihood.reweigh(SURE | {"k6": 1e-5})
    assert likelihood.weights[:200].min() > 0.99
    assert likelihood.weights[200:].max() < 0.01
    assert likelihood.stray_per_us[0] == pytest.approx(10 / lengths.sum(), rel=0.01)
