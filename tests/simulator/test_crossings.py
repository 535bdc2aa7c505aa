"""The paths of a band's pixels over a step, against closed forms and brute force.

Seeds are fixed; P_LIMIT is the chance that a correct sampler would fail one assertion for a random seed.
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator.crossings import cross
from voltcam_simulator.effect import STRAIGHT
from voltcam_simulator.groups import Kicks, Motion, Pixels, Reset, Step
from voltcam_simulator.paths import BLOCK
from voltcam_simulator.random import CROSSINGS, interval_key

from .brownian import crossings, fine_steps, first_exit_cdf

P_LIMIT = 1e-4

# drift and noise over the whole interval, in thresholds
CASES = [
    pytest.param(0.3, 1.0, 0.1, 1.0, 1.0, id="certain-low-noise"),
    pytest.param(0.0, 0.9, 0.15, 1.0, 1.0, id="marginal-low-noise"),
    pytest.param(0.0, 0.0, 0.5, 1.0, 1.0, id="no-drift"),
    pytest.param(0.7, -0.5, 0.6, 1.0, 0.5, id="against-drift-asymmetric"),
    pytest.param(-0.45, 0.4, 1.0, 1.0, 0.5, id="noise-of-the-band"),
    pytest.param(0.2, 3.0, 2.0, 0.6, 1.4, id="high-noise"),
    pytest.param(0.0, -2.0, 6.0, 1.0, 1.0, id="three-bands-of-noise"),
]


def first_of(pixel: NDArray[np.int64]) -> NDArray[np.int64]:
    """Index of the first event of each pixel that has one (events of a pixel are in order of time)."""
    return np.unique(pixel, return_index=True)[1]


@pytest.mark.parametrize(("start", "drift", "noise", "above", "below"), CASES)
def test_first_exit_has_the_closed_form(
    start: float, drift: float, noise: float, above: float, below: float
) -> None:
    n, blocks = 8000, 13  # x coordinates have 13 bits, so pixels come in blocks of 8000
    times, sides = [], []
    for seed in range(blocks):
        pixel, time, on, _ = crossings(n, start, drift, noise, above, below, seed)
        first = first_of(pixel)
        times.append(time[first])
        sides.append(on[first])
    time, on = np.concatenate(times), np.concatenate(sides)
    grid = np.linspace(1e-6, 1, 200_001)
    cdfs = first_exit_cdf(grid, start, drift, noise, above, below)
    for polarity, cdf in zip((True, False), cdfs, strict=True):
        count = int((on == polarity).sum())
        assert stats.binomtest(count, n * blocks, min(float(cdf[-1]), 1.0)).pvalue > P_LIMIT
        if count > 100:
            observed = time[on == polarity] + 0.5e-6  # stamps are rounded down to 1 us
            p = stats.kstest(observed, lambda t, c=cdf: np.interp(t, grid, c / c[-1])).pvalue
            assert p > P_LIMIT


@pytest.mark.parametrize(("start", "drift", "noise", "above", "below"), CASES)
def test_all_events_and_the_end_agree_with_fine_steps(
    start: float, drift: float, noise: float, above: float, below: float
) -> None:
    n = 3000
    pixel, time, on, end = crossings(n, start, drift, noise, above, below)
    pixel_f, time_f, on_f, end_f = fine_steps(n, start, drift, noise, above, below, steps=8000)
    assert stats.ks_2samp(end, end_f).pvalue > P_LIMIT
    for polarity in (True, False):
        counts = np.bincount(pixel[on == polarity], minlength=n)
        counts_f = np.bincount(pixel_f[on_f == polarity], minlength=n)
        spread = np.sqrt((counts.var() + counts_f.var()) / n)
        # brute force still misses a little of each excursion: 1 % of the events is allowed for
        assert abs(counts.mean() - counts_f.mean()) <= 4 * spread + 0.01 * counts_f.mean()
    if noise < 2 and len(time_f) > 50:
        assert stats.ks_2samp(time, time_f).pvalue > P_LIMIT


def test_without_noise_it_is_linear_integrate_and_fire() -> None:
    pixel, time, on, end = crossings(4, 0.25, 3.5, 0.0, 1.0, 0.7)
    expected = (np.array([1, 2, 3]) - 0.25) / 3.5
    np.testing.assert_allclose(time[pixel == 2], expected, atol=1.01e-6)
    assert on.all()
    np.testing.assert_allclose(end, 0.75, atol=1e-6)
    pixel, time, on, end = crossings(4, 0.25, -3.5, 0.0, 1.0, 0.7)
    np.testing.assert_allclose(time[pixel == 0], (0.25 + 0.7 * np.arange(1, 5)) / 3.5, atol=1.01e-6)
    assert not on.any()
    np.testing.assert_allclose(end, 0.25 - 3.5 + 4 * 0.7, atol=1e-6)


def test_vanishing_noise_tends_to_integrate_and_fire() -> None:
    pixel, time, _, _ = crossings(1000, 0.0, 5.5, 1e-5, 1.0, 1.0)
    assert np.bincount(pixel).tolist() == [5] * 1000
    time = time[np.argsort(pixel, kind="stable")]
    np.testing.assert_allclose(time.reshape(1000, 5), np.tile(np.arange(1, 6) / 5.5, (1000, 1)), atol=2e-5)


def test_a_start_on_a_barrier_fires_at_once() -> None:
    pixel, time, on, _ = crossings(100, 1.0, 0.0, 0.3, 1.0, 1.0)
    first = first_of(pixel)
    assert first.size == 100
    assert (time[first] == 0).all()
    assert on[first].all()


def cross_all(
    n: int, *, drift: float = 0.0, noise: float = 0.0, pending: float = 0.0, held_us: float = 0.0,
    kicks: tuple[float, float] | None = None, room: int = 10_000, seed: int = 1,
) -> tuple[NDArray[np.uint64], Pixels]:  # fmt: skip
    """n pixels at 0 over a millisecond, `cross` called again until all are done."""
    pixels = Pixels(*(np.full(n, level, np.float32) for level in (0, pending, held_us, 1, 1)))
    size = 0.0 if kicks is None else kicks[1]
    motion = Motion(*(np.full(n, v, np.float32) for v in (drift + size, noise / np.sqrt(1000))))
    step = Step(interval_key(seed, CROSSINGS, 0), 1000.0, 0.0, 0, n)
    kick = [] if kicks is None else [kicks]
    columns = (np.array([k[i] for k in kick], np.float64).reshape(-1, 1) for i in (0, 1))
    groups = Kicks(*columns, np.full(n, abs(size), np.float32))
    near, bent = np.arange(n, dtype=np.int32), np.empty(0, np.int32)
    done, keys = 0, np.empty(0, np.uint64)
    while done < n:
        space = np.empty(room, np.uint64)
        done, written = cross(
            *pixels, *motion, *step, *Reset(0.0, 0.0), *groups, *STRAIGHT, True, near, bent, done, space
        )
        keys = np.concatenate([keys, space[:written]])
    return keys, pixels


def test_less_room_at_a_time_gives_the_same_events() -> None:
    """Three blocks of pixels; the room is enough for one at a time."""
    n = 2 * BLOCK + 100
    whole, pixels = cross_all(n, noise=1.5, room=100 * n)
    parts, same = cross_all(n, noise=1.5, room=9 * BLOCK)
    assert len(whole) > n
    np.testing.assert_array_equal(parts, whole)
    np.testing.assert_array_equal(same.voltage, pixels.voltage)


def test_variance_that_is_pending_is_drawn_with_the_step() -> None:
    """No noise now, 0.04 gathered before: N(0, 0.2), held within the thresholds five deviations off."""
    keys, pixels = cross_all(4000, drift=0.0, pending=0.04)
    assert (pixels.pending == 0).all()
    assert len(keys) == 0
    assert stats.kstest(pixels.voltage, stats.norm(0, 0.2).cdf).pvalue > P_LIMIT


@pytest.mark.parametrize(("held_us", "voltage", "left_us"), [(250, 0.6, 0), (1400, 0.0, 400)])
def test_a_pixel_in_its_dead_time_starts_when_that_ends(
    held_us: float, voltage: float, left_us: float
) -> None:
    keys, pixels = cross_all(5, drift=0.8, held_us=held_us)
    assert len(keys) == 0
    np.testing.assert_allclose(pixels.voltage, voltage, rtol=1e-6)
    np.testing.assert_allclose(pixels.held, left_us)


def test_noise_comes_only_in_the_time_that_a_pixel_is_free() -> None:
    _, pixels = cross_all(4000, noise=0.2, held_us=750)
    assert stats.kstest(pixels.voltage, stats.norm(0, 0.1).cdf).pvalue > P_LIMIT


def test_a_kicked_pixel_fires_at_the_kick_and_once() -> None:
    keys, pixels = cross_all(5, drift=0.5, kicks=(400.0, 0.9))
    assert (keys >> np.uint64(27)).tolist() == [400] * 5
    np.testing.assert_allclose(pixels.voltage, 0.5 * 0.6, rtol=1e-6)
