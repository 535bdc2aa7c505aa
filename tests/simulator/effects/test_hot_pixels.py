"""Hot pixels by their signature: the same few pixels fire, whatever is seen."""

import numpy as np
from scipy import stats

from voltcam_simulator import Simulator

from ..scenes import Events, only, watch_still

SIDE, PIXELS, SECONDS = 100, 10_000, 30


def counts(grey: float, fps: float = 4, **hot: float) -> tuple[Events, np.ndarray]:
    simulator = Simulator(SIDE, SIDE, only(hot_pixels=hot), seed=3)
    events = watch_still(simulator, grey, SECONDS, fps)
    return events, np.bincount(events["y"].astype(int) * SIDE + events["x"], minlength=PIXELS)


def test_a_fixed_few_fire_in_the_dark_and_in_the_light() -> None:
    _, dark = counts(0, fraction=0.01, rate_hz=20)
    _, light = counts(255, fraction=0.01, rate_hz=20, fps=11)
    # the slowest of 100 has 20 * 10^(-0.3 * 3.5) = 1.8 Hz: 53 events, none with chance e^-53
    assert (dark > 0).sum() == 100
    assert ((dark > 0) == (light > 0)).all()
    total = dark.sum() + light.sum()
    assert abs(dark.sum() - light.sum()) < 5 * np.sqrt(total)  # Poisson: chance 6e-7


def test_rates_are_log_normal_and_events_poisson_and_mostly_on() -> None:
    events, count = counts(100, fraction=0.02, rate_hz=30, spread_decades=0.5, on_share=0.9)
    rates = np.log10(count[count > 0] / SECONDS)
    # counting adds less than 0.03 decades to the spread
    assert stats.kstest(rates, stats.norm(np.log10(30), 0.5).cdf).pvalue > 1e-4
    assert stats.binomtest(int(events["p"].sum()), len(events), 0.9).pvalue > 1e-4
    top = int(count.argmax())
    mine = events["t"][(events["y"].astype(int) * SIDE + events["x"]) == top]
    assert stats.kstest(np.diff(mine), stats.expon(scale=np.diff(mine).mean()).cdf).pvalue > 1e-4


def test_a_larger_fraction_adds_pixels_to_those_there() -> None:
    _, few = counts(0, fraction=0.01, rate_hz=20)
    _, many = counts(0, fraction=0.03, rate_hz=20)
    assert (many > 0).sum() == 300
    assert (many[few > 0] > 0).all()
