"""Reset noise: intervals that spread anew at each event."""

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Simulator

from ..scenes import intervals_us, only, watch_still

SIDE = 50


@pytest.mark.parametrize("fps", [0.5, 30])
def test_leak_intervals_spread_by_sigma_and_not_by_pixel(fps: float) -> None:
    parameters = only(junction_leak={"k4_per_us": 1e-5}, reset_noise={"sigma": 0.1})
    between = intervals_us(watch_still(Simulator(SIDE, SIDE, parameters, seed=5), 9, 2, fps), SIDE)
    by_pixel = between[: len(between) // 18 * 18]
    # from x0 ~ N(0, 0.1) to 1 at 1e-5 per us; the window of 2 s favours short ones by less than .1 %
    assert stats.kstest(between, stats.norm(1e5, 1e4).cdf).pvalue > 1e-4
    assert abs(np.corrcoef(by_pixel[:-1], by_pixel[1:])[0, 1]) < 5 / np.sqrt(len(by_pixel))


def test_without_it_the_same_pixels_are_clocks() -> None:
    between = intervals_us(
        watch_still(Simulator(SIDE, SIDE, only(junction_leak={"k4_per_us": 1e-5}), seed=5), 9, 2, 30), SIDE
    )
    np.testing.assert_allclose(between, 1e5, atol=1.5)


def test_it_never_starts_beyond_a_threshold() -> None:
    parameters = only(
        junction_leak={"k4_per_us": 1e-5}, reset_noise={"sigma": 0.5},
        comparator={"theta_on": 0.2, "theta_off": 0.1},
    )  # fmt: skip
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=6), 9, 1, 30)
    between = intervals_us(events, SIDE)
    assert events["p"].all()
    # from nine tenths of the way up, or down, at most
    assert between.min() >= (0.2 - 0.18) * 1e5 - 2
    assert between.max() <= (0.2 + 0.09) * 1e5 + 2
