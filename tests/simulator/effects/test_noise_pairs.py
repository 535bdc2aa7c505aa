"""Noise pairs by their signature: short intervals between opposite polarities, most in the dark."""

import math

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Simulator

from ..scenes import Events, only, watch_still

SIDE, PIXELS, SECONDS = 60, 3600, 10


def at_rest(grey: float, fps: float, **noise: float) -> Events:
    simulator = Simulator(SIDE, SIDE, only(noise_pairs=noise), seed=5)
    return watch_still(simulator, grey, SECONDS, fps)


@pytest.mark.parametrize("fps", [5, 1000])
def test_each_event_is_followed_by_its_opposite_after_an_exponential_wait(fps: float) -> None:
    """1 ms frames cut most pairs of 2 ms apart; nothing of that shows."""
    events = at_rest(0, fps, rate_hz=0.2, interval_us=2000)
    order = np.lexsort((events["t"], events["x"], events["y"]))
    events = events[order]
    same = (np.diff(events["x"].astype(int)) == 0) & (np.diff(events["y"].astype(int)) == 0)
    wait = np.diff(events["t"])
    paired = same & (wait < 20_000)
    pairs = 0.2 * PIXELS * SECONDS
    # of two pairs in one pixel, one in 250 falls between or within 20 ms of the other
    assert paired.sum() == pytest.approx(pairs, abs=5 * math.sqrt(pairs) + pairs / 100)
    opposite = events["p"][1:][paired] != events["p"][:-1][paired]
    assert opposite.mean() > 0.98
    short = wait[paired & (events["p"][1:] != events["p"][:-1])]
    assert stats.kstest(short, stats.expon(scale=2000).cdf).pvalue > 1e-4
    assert stats.binomtest(int(events["p"].sum()), len(events), 0.5).pvalue > 1e-4


def test_there_are_half_as_many_at_the_stated_brightness() -> None:
    for grey, share in ((0, 1), (10, 1 / 2), (90, 1 / 10)):
        events = at_rest(grey, 20, rate_hz=0.5, half_dn=10, interval_us=1000)
        pairs = 0.5 * PIXELS * SECONDS * share
        assert len(events) / 2 == pytest.approx(pairs, abs=5 * math.sqrt(pairs))
