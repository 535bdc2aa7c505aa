"""The laws of one bridge between two instants, against closed forms and other people's distributions."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator.first_passage import (
    MISS,
    exit_of_bridge,
    inverse_gaussian,
    needs_cut,
    stays_inside,
    touch_probability,
    touching_time,
)

P_LIMIT = 1e-4  # chance that a correct sampler would fail one assertion for a random seed


def test_inverse_gaussian_has_its_law_down_to_levy() -> None:
    def draws(inverse_mean: float, shape: float) -> NDArray[np.float64]:
        state, values = np.uint64(99), []
        for _ in range(20_000):
            state, value = inverse_gaussian(np.uint64(state), inverse_mean, shape)
            values.append(value)
        return np.array(values)

    for mean, shape in ((1.0, 1.0), (0.1, 5.0), (50.0, 0.3), (1e6, 1e-3)):
        law = stats.invgauss(mu=mean / shape, scale=shape)
        assert stats.kstest(draws(1 / mean, shape), law.cdf).pvalue > P_LIMIT
    assert stats.kstest(draws(0.0, 2.0), stats.levy(scale=2.0).cdf).pvalue > P_LIMIT


@pytest.mark.parametrize(("distance", "beyond"), [(0.4, 0.7), (1.0, 0.1), (0.3, 0.0)])
def test_a_bridge_first_touches_a_barrier_when_an_inverse_gaussian_says(
    distance: float, beyond: float
) -> None:
    """tau = T s/(1 + s) with s ~ IG(mean distance/beyond, shape distance^2/v); end on the barrier: Levy."""
    span, variance, state, times = 2000.0, 0.3, np.uint64(7), []
    for _ in range(5000):
        state, time = touching_time(np.uint64(state), distance, beyond, span, variance)
        times.append(time)
    shape = distance**2 / variance
    law = stats.levy(scale=shape)
    if beyond > 0:
        law = stats.invgauss(mu=distance / beyond / shape, scale=shape)
    share = np.array(times) / span
    assert stats.kstest(share / (1 - share), law.cdf).pvalue > P_LIMIT


def test_how_likely_a_touch_is_by_the_reflection_principle() -> None:
    """exp(-2 near far/v) at any scale, surely from or to beyond the barrier, never below MISS."""
    for near, far, variance in ((0.5, 0.4, 0.3), (0.05, 0.04, 0.003), (1.0, 2.0, 0.2)):
        expected = math.exp(-2 * near * far / variance)
        assert touch_probability(near, far, variance) == pytest.approx(expected, rel=1e-12)
    assert touch_probability(0.5, -0.1, 0.3) == touch_probability(0.0, 0.4, 0.3) == 1
    limit = -0.5 * math.log(MISS)
    assert touch_probability(limit * 0.999, 1.0, 1.0) > MISS * 0.99
    assert touch_probability(limit * 1.001, 1.0, 1.0) == 0


@pytest.mark.parametrize(("x", "y"), [(0.5, 0.6), (-0.2, -0.7), (0.2, 1.3), (0.1, -1.4)])
def test_the_side_on_which_a_bridge_leaves_its_band(x: float, y: float) -> None:
    """One that can reach one barrier only: there with the probability of reflection, or it stays inside."""
    above, below, variance, span, n = 1.0, 1.2, 0.05, 500.0, 4000
    assert not needs_cut(x, y, above, below, variance)
    state, sides, times = np.uint64(3), [], []
    for _ in range(n):
        state, side, time = exit_of_bridge(np.uint64(state), x, y, span, variance, above, below)
        sides.append(side)
        times.append(time)
    on = math.exp(-2 * (above - x) * max(above - y, 0) / variance)
    off = math.exp(-2 * (x + below) * max(y + below, 0) / variance)
    assert stats.binomtest(sides.count(1), n, min(on, 1.0)).pvalue > P_LIMIT
    assert stats.binomtest(sides.count(-1), n, min(off, 1.0)).pvalue > P_LIMIT
    assert all((time == span) == (side == 0) for side, time in zip(sides, times, strict=True))
    assert max(times) <= span


def test_a_bridge_is_cut_only_where_it_may_reach_both_barriers() -> None:
    """From the middle to the middle of (-1, 1): up and then down has the probability exp(-2 2 2/v)."""
    limit = -8 / math.log(MISS)
    assert needs_cut(0.0, 0.0, 1.0, 1.0, 1.01 * limit)
    assert not needs_cut(0.0, 0.0, 1.0, 1.0, 0.99 * limit)
    assert not needs_cut(1.0, 0.0, 1.0, 1.0, 100.0)  # already on a barrier: it leaves there, now
    assert not needs_cut(0.0, 5.0, 1.0, 1.0, 0.0)  # no noise: a straight line


def test_a_bridge_that_stays_inside_keeps_off_both_barriers() -> None:
    limit = -2 * 0.25 / math.log(MISS)  # of a bridge between two points half a threshold off
    assert stays_inside(0.5, 0.5, 1.0, 9.0, 0.99 * limit)
    assert not stays_inside(0.5, 0.5, 1.0, 9.0, 1.01 * limit)
    assert stays_inside(-0.5, -0.5, 9.0, 1.0, 0.99 * limit)
    assert not stays_inside(-0.5, -0.5, 9.0, 1.0, 1.01 * limit)
    assert not stays_inside(0.5, 1.0, 1.0, 9.0, 0.0)
