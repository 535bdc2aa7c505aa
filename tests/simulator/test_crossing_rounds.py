"""Events of many pixels in rounds: the same law as following each pixel by itself."""

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator.crossing_rounds import ROUNDS, Unfinished, find_unfinished, next_crossings
from voltcam_simulator.first_passage import stays_inside
from voltcam_simulator.groups import Reset

from .brownian import crossings

P_LIMIT = 1e-4  # chance that a correct sampler would fail one assertion for a random seed
NO_RESET = Reset(0.0, 0.0)


def unfinished(n: int, x: float, y: float, noise2: float, left: float, below: float = 1.0) -> Unfinished:
    """n paths alike, of a threshold of 1 above."""
    levels = (x, y, 1.0, below, noise2, left, 9.0, 9.0)
    return Unfinished(np.arange(1, n + 1, dtype=np.uint64), *(np.full(n, v, np.float64) for v in levels))


def draw(paths: Unfinished, reset: Reset = NO_RESET) -> Unfinished:
    next_crossings(paths, reset, np.empty((3, paths.states.size)))
    return paths


def test_without_noise_the_next_event_is_on_the_straight_line() -> None:
    up = draw(unfinished(3, 0.25, 1.75, 0.0, 300.0))
    assert up.side.tolist() == [1] * 3
    np.testing.assert_allclose(up.time, 150)  # what is left
    np.testing.assert_allclose((up.x[0], up.y[0], up.left[0]), (0, 0.75, 150))
    down = draw(unfinished(3, 0.25, -1.5, 0.0, 350.0, below=0.5))
    assert down.side.tolist() == [-1] * 3
    np.testing.assert_allclose((down.x[0], down.y[0], down.left[0]), (0, -1.0, 200))


@pytest.mark.parametrize(("x", "y", "noise2"), [(0.0, 0.5, 1e-5), (-0.99, 1.01, 1e-2)])
def test_a_path_that_does_not_surely_cross_one_side_alone_stays_as_it_is(
    x: float, y: float, noise2: float
) -> None:
    paths = draw(unfinished(4, x, y, noise2, 100.0), Reset(10.0, 0.1))
    assert paths.side.tolist() == [0] * 4
    assert (paths.x == x).all()
    assert (paths.y == y).all()
    assert (paths.left == 100).all()
    assert (paths.time == 100).all()


def test_the_time_of_the_event_has_its_law() -> None:
    """tau = T s/(1 + s) with s ~ IG(near/beyond, near^2/v), here near 0.8, beyond 0.5, v 0.02."""
    n, left = 20_000, 1000.0
    paths = draw(unfinished(n, 0.2, 1.5, 0.02 / left, left))
    share = 1 - paths.time / left
    shape = 0.8**2 / 0.02
    law = stats.invgauss(mu=0.8 / 0.5 / shape, scale=shape)
    assert stats.kstest(share / (1 - share), law.cdf).pvalue > P_LIMIT


def test_the_dead_time_takes_its_share_of_the_rest() -> None:
    """A bridge from 0 to y over the rest is after d at N(y d/rest, v (d/rest)(1 - d/rest))."""
    n, left, noise2 = 20_000, 1000.0, 2e-5
    without, with_dead = (draw(unfinished(n, 0.2, 1.5, noise2, left), Reset(dead, 0.0)) for dead in (0, 100))
    np.testing.assert_array_equal(with_dead.time, without.time)
    np.testing.assert_allclose(with_dead.left, without.left - 100)
    lost = without.y - with_dead.y
    share = 100 / without.left
    spread = np.sqrt(noise2 * 100 * (1 - share))
    assert stats.kstest((lost - without.y * share) / spread, stats.norm.cdf).pvalue > P_LIMIT
    late = draw(unfinished(5, 0.2, 1.0, 0.0, left), Reset(100.0, 0.0))
    assert (late.left < 0).all()  # the dead time goes beyond the step: all is lost
    np.testing.assert_allclose(late.y, 0, atol=1e-12)


def test_reset_noise_moves_the_whole_path() -> None:
    paths = draw(unfinished(20_000, 0.25, 1.75, 0.0, 300.0, below=0.5), Reset(0.0, 0.2))
    np.testing.assert_allclose(paths.y - 0.75, paths.x)
    level = np.clip(paths.x, -0.45, 0.9)
    np.testing.assert_array_equal(level, paths.x)
    inside = paths.x[paths.x > -0.45]
    cut = stats.truncnorm(-0.45 / 0.2, 0.9 / 0.2, scale=0.2)
    assert stats.kstest(inside, cut.cdf).pvalue > P_LIMIT
    assert stats.binomtest(20_000 - inside.size, 20_000, stats.norm.cdf(-0.45 / 0.2)).pvalue > P_LIMIT


def test_who_goes_on_is_who_may_touch_a_threshold_in_the_time_left() -> None:
    rng = np.random.default_rng(2)
    n = 500
    x, y = rng.uniform(-1.1, 1.1, (2, n))
    left = rng.uniform(-50, 100, n)
    ones = np.ones(n)
    paths = Unfinished(np.zeros(n, np.uint64), x, y, ones, ones, 1e-3 * ones, left, ones, ones)
    places = np.empty(n + 1, np.int64)
    count = find_unfinished(paths, np.empty(places.size, np.bool_), places)
    expected = [i for i in range(n) if left[i] > 0 and not stays_inside(x[i], y[i], 1.0, 1.0, 1e-3 * left[i])]
    assert 0 < count < n
    assert places[:count].tolist() == expected


def test_events_beyond_the_rounds_are_not_lost() -> None:
    """A straight line through more thresholds than there are rounds: each has its event, at its time."""
    count = 2 * ROUNDS + 1
    pixel, time, on, end = crossings(6, 0.0, count + 0.5, 0.0, 1.0, 1.0)
    assert on.all()
    for each in range(6):
        expected = np.arange(1, count + 1) / (count + 0.5)
        np.testing.assert_allclose(np.sort(time[pixel == each]), expected, atol=1.01e-6)
    np.testing.assert_allclose(end, 0.5, atol=1e-5)
