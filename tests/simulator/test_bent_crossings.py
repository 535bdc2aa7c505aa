"""Paths that are bent over a step: drawn in straight pieces, against brute force along the curve.

Seeds are fixed; P_LIMIT is the chance that a correct sampler would fail one assertion for a random seed.
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator.bends import TOLERANCE, depth
from voltcam_simulator.crossings import cross
from voltcam_simulator.groups import Bend, Kicks, Motion, Pixels, Reset, Step
from voltcam_simulator.random import CROSSINGS, interval_key

from .brownian import SPAN_US, Floats, bent_path, fine_steps

P_LIMIT = 1e-4
Found = tuple[NDArray[np.int64], Floats, NDArray[np.bool_], Pixels]


def bent(
    n: int, drift: float, transient: float, rate: float, noise: float = 0.0, *, start: float = 0.0,
    above: float = 1.0, below: float = 1.0, held_us: float = 0.0, dead_us: float = 0.0,
    kick: tuple[float, float] | None = None, room: int = 200_000,
) -> Found:  # fmt: skip
    """n pixels over one second by the kernel, their mean as `bent_path`.

    Returns (pixel, time [s], ON?) of all events, and the pixels afterwards.
    """
    pixels = Pixels(*(np.full(n, level, np.float32) for level in (start, 0, held_us, above, below)))
    size = 0.0 if kick is None else kick[1]
    motion = Motion(*(np.full(n, v, np.float32) for v in (drift + size, noise / np.sqrt(SPAN_US))))
    rates = np.full(n, rate, np.float32)
    bend = Bend(-depth(rates) * np.float32(transient), rates)
    step = Step(interval_key(1, CROSSINGS, 0), SPAN_US, 0.0, first_pixel=0, width=n)
    times, sizes = (np.array([kick[i]] if kick else [], np.float64).reshape(-1, 1) for i in (0, 1))
    kicks = Kicks(times, sizes, np.full(n, abs(size), np.float32))
    careful, near, done = kick is not None or held_us > 0 or dead_us > 0, np.empty(0, np.int32), 0
    numbers, keys = np.arange(n, dtype=np.int32), np.empty(0, np.uint64)
    while done < n:
        space = np.empty(room, np.uint64)
        done, written = cross(
            *pixels, *motion, *step, *Reset(dead_us, 0.0), *kicks, *bend, careful, near, numbers, done, space
        )
        keys = np.concatenate([keys, space[:written]])
    pixel = (keys >> np.uint64(1) & np.uint64(0x1FFF)).astype(np.int64)
    return pixel, (keys >> np.uint64(27)) / SPAN_US, (keys & np.uint64(1)).astype(bool), pixels


CURVES = [
    pytest.param(2.5, 2.6, 4.0, id="late"),
    pytest.param(-1.7, 0.9, 12.0, id="early"),
    pytest.param(0.0, -5.5, 3.0, id="out-and-back"),
    pytest.param(0.4, 17.0, 1.0, id="back-and-out"),
]


def integrate_and_fire(curve: Floats) -> list[float]:
    """The changes of level, of one threshold each, along a curve."""
    level, steps = 0.0, []
    for value in curve:
        if abs(value - level) >= 1:
            steps.append(float(np.sign(value - level)))
            level += steps[-1]
    return steps


@pytest.mark.parametrize(("drift", "transient", "rate"), CURVES)
def test_without_noise_events_come_where_the_curve_is_a_threshold_further(
    drift: float, transient: float, rate: float
) -> None:
    pixel, time, on, pixels = bent(3, drift, transient, rate)
    grid = np.linspace(0, 1, 20_001)
    curve = bent_path(drift, transient, rate, grid)
    steps = np.where(on[pixel == 1], 1.0, -1.0)
    assert steps.tolist() == integrate_and_fire(curve)
    assert steps.size > 0
    there = np.interp(time[pixel == 1], grid, curve)
    np.testing.assert_allclose(there, np.cumsum(steps), atol=1.1 * max(TOLERANCE, abs(drift) / 64))
    np.testing.assert_allclose(pixels.voltage, drift - steps.sum(), atol=1e-5)


@pytest.mark.parametrize("noise", [0.1, 0.5, 1.5])
@pytest.mark.parametrize(("drift", "transient", "rate"), CURVES)
def test_all_events_and_the_end_agree_with_fine_steps(
    drift: float, transient: float, rate: float, noise: float
) -> None:
    n, steps = 3000, 8000
    start, above, below = 0.2, 1.0, 0.7
    pixel, time, on, pixels = bent(n, drift, transient, rate, noise, start=start, above=above, below=below)
    curve = bent_path(drift, transient, rate, np.arange(1, steps + 1) / steps)
    pixel_f, time_f, on_f, end_f = fine_steps(n, start, curve, noise, above, below, steps)
    # a path may be off by the tolerance: what is compared is moved by that much at most
    off = max(TOLERANCE, abs(drift) / 64)
    for polarity in (True, False):
        counts = np.bincount(pixel[on == polarity], minlength=n)
        counts_f = np.bincount(pixel_f[on_f == polarity], minlength=n)
        spread = np.sqrt((counts.var() + counts_f.var()) / n)
        assert abs(counts.mean() - counts_f.mean()) <= 4 * spread + off + 0.01 * counts_f.mean()
    assert nearest(pixels.voltage, end_f, 0.02) > P_LIMIT
    if len(time_f) > 50:
        assert nearest(time, time_f, 0.02) > P_LIMIT


def nearest(a: NDArray[np.floating], b: Floats, off: float) -> float:
    """The p-value of two samples that may differ in distribution by `off`, by Kolmogorov and Smirnov."""
    found = stats.ks_2samp(a, b)
    n = len(a) * len(b) / (len(a) + len(b))
    return float(stats.kstwobign.sf(max(found.statistic - off, 0) * np.sqrt(n)))


def test_less_room_at_a_time_gives_the_same_events() -> None:
    n = 20_000
    whole, parts = (bent(n, 1.8, 2.0, 5.0, 0.5, room=room) for room in (1_000_000, 30_000))
    assert len(whole[0]) > n
    np.testing.assert_array_equal(parts[1], whole[1])
    np.testing.assert_array_equal(parts[3].voltage, whole[3].voltage)
    np.testing.assert_array_equal(parts[3].pending, whole[3].pending)


def test_pixels_of_a_block_are_cut_each_by_itself() -> None:
    """Alike pixels with other neighbours: the numbers of a pixel are its own, so its events are."""
    alone, among = bent(1, 1.8, 2.0, 5.0, 0.5), bent(500, 1.8, 2.0, 5.0, 0.5)
    np.testing.assert_array_equal(alone[1], among[1][among[0] == 0])
    assert alone[3].voltage[0] == among[3].voltage[0]


def test_a_dead_time_begins_in_one_piece_and_ends_in_another() -> None:
    """Most of the way is gone in the first tenth: what the curve does in the dead time is lost."""
    drift, transient, rate = 1.5, -1.3, 20.0
    pixel, time, _, pixels = bent(2, drift, transient, rate, dead_us=300_000.0)
    grid = np.linspace(0, 1, 100_001)
    curve = bent_path(drift, transient, rate, grid)
    fired = float(grid[np.argmax(curve >= 1)])
    assert fired < 0.1
    assert pixel.tolist() == [0, 1]
    np.testing.assert_allclose(np.interp(time, grid, curve), 1, atol=0.025)
    free = float(np.interp(time[0] + 0.3, grid, curve))
    np.testing.assert_allclose(pixels.voltage, drift - free, atol=0.025)


def test_a_pixel_that_is_held_when_the_step_begins_goes_on_from_there() -> None:
    pixel, _, _, pixels = bent(2, 0.7, -1.5, 3.0, held_us=400_000.0)
    missed = float(bent_path(0.7, -1.5, 3.0, np.array([0.4]))[0])
    assert pixel.size == 0
    np.testing.assert_allclose(pixels.voltage, 0.7 - missed, atol=0.012)
    assert (pixels.held == 0).all()


@pytest.mark.parametrize(("at_s", "size", "fires"), [(0.3, 0.6, True), (0.9, 0.6, False), (0.5, -1.7, True)])
def test_a_kick_comes_at_its_time_on_the_curve(at_s: float, size: float, fires: bool) -> None:
    """The curve goes up by 0.65 and back to 0: kicked on its way out it fires, kicked late it does not."""
    drift, transient, rate = 0.0, -3.2, 2.0
    pixel, time, on, pixels = bent(2, drift, transient, rate, kick=(at_s * SPAN_US, size))
    grid = np.linspace(0, 1, 100_001)
    curve = bent_path(drift, transient, rate, grid)
    assert 0.6 < curve.max() < 0.7
    kicked = curve + size * (grid >= at_s)
    beyond = np.abs(kicked) >= 1
    assert beyond.any() == fires
    assert (pixel.size > 0) == fires
    if fires:
        first = np.argmax(beyond)
        assert abs(np.interp(time[pixel == 0][0], grid, kicked)) >= 0.988
        np.testing.assert_allclose(time[pixel == 0][0], grid[first], atol=0.03)
        assert on[pixel == 0][0] == (kicked[first] > 0)
    else:
        np.testing.assert_allclose(pixels.voltage, size, atol=1e-4)
