"""Maxima that are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from scipy.special import gammaln

from voltcam_lab.calibration.ascent import LONGEST, Prior, ascend, scores

NONE = Prior(np.zeros(2), np.full(2, 1e3))


def test_the_ascent_finds_the_maximum_between_data_and_prior() -> None:
    data = np.array([1.0, 2.0, 3.0, 6.0])
    prior = Prior(np.array([0.0]), np.array([0.5]))
    found = ascend(lambda x: -0.5 * (data - x[0]) ** 2, np.array([0.0]), prior, tolerance=1e-9)
    assert found[0] == pytest.approx(data.sum() / (4 + 1 / 0.25), rel=1e-3)


def counts(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Poisson counts whose log rate is 1 + .7 u, at u."""
    rng = np.random.default_rng(seed)
    u = rng.uniform(-1, 1, 200)
    return rng.poisson(np.exp(1 + 0.7 * u)).astype(float), u


def test_it_finds_what_scipy_finds() -> None:
    """Of a Poisson regression, with and without a prior that pulls."""
    n, u = counts(1)

    def parts(x: np.ndarray) -> np.ndarray:
        log = x[0] + x[1] * u
        return n * log - np.exp(log) - gammaln(n + 1)

    for prior in (NONE, Prior(np.array([0.0, 2.0]), np.array([0.05, 0.3]))):
        found = ascend(parts, np.zeros(2), prior, tolerance=1e-10)
        wanted = minimize(lambda x, prior=prior: -(parts(x).sum() + prior.of(x)), np.zeros(2), tol=1e-10).x
        assert found == pytest.approx(wanted, abs=1e-3)


def test_scores_are_derivatives_of_each_part() -> None:
    n, u = counts(2)
    x = np.array([0.8, 0.5])
    rate = np.exp(x[0] + x[1] * u)
    found = scores(lambda x: n * (x[0] + x[1] * u) - np.exp(x[0] + x[1] * u), x)
    assert found == pytest.approx(np.stack([n - rate, (n - rate) * u]), abs=1e-3)


@settings(deadline=None)
@given(st.integers(0, 1000), st.floats(-3, 3), st.floats(-3, 3), st.integers(1, 4))
def test_it_never_ends_lower_than_it_began_nor_goes_further_than_it_may(
    seed: int, a: float, b: float, steps: int
) -> None:
    """Even where the likelihood bends the wrong way."""
    height = np.random.default_rng(seed).normal(0, 1, (6, 4))

    def parts(x: np.ndarray) -> np.ndarray:
        return height @ np.array([np.sin(2 * x[0]), np.cos(x[1]), np.sin(x[0] + x[1]), -0.1 * x @ x])

    prior, start = Prior(np.zeros(2), np.ones(2)), np.array([a, b])
    found = ascend(parts, start, prior, steps)
    assert parts(found).sum() + prior.of(found) >= parts(start).sum() + prior.of(start)
    assert np.abs(found - start).max() <= steps * LONGEST + 1e-9


def test_parts_that_are_sums_of_many_count_as_so_many() -> None:
    """100 measurements as 100 parts or as 4 sums of 25: the same maximum."""
    data = np.random.default_rng(3).normal(2, 1, (4, 25))
    prior = Prior(np.array([0.0]), np.array([1.0]))
    one = ascend(lambda x: -0.5 * ((data - x[0]) ** 2).ravel(), np.zeros(1), prior, tolerance=1e-10)
    few = ascend(
        lambda x: -0.5 * ((data - x[0]) ** 2).sum(axis=1),
        np.zeros(1),
        prior,
        tolerance=1e-10,
        counts=np.full(4, 25.0),
    )
    assert few == pytest.approx(one, abs=1e-3)
    assert one == pytest.approx(data.sum() / 101, rel=1e-3)


def test_a_prior_is_the_normal_law() -> None:
    prior = Prior(np.array([1.0, -2.0]), np.array([0.5, 3.0]))
    x = np.array([1.5, 1.0])
    assert prior.of(x) == pytest.approx(-0.5 * (1 + 1))
    assert prior.pull(x) == pytest.approx([-2.0, -1 / 3])
