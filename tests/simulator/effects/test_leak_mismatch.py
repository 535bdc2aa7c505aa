"""Leak mismatch: a log-normal spread of the leak that stays with the pixels."""

import numpy as np
from scipy import stats

from voltcam_simulator import Simulator

from ..scenes import Events, only, watch_still

SIDE = 60
SIGMA = 0.23


def counts(events: Events) -> np.ndarray:
    return np.bincount(events["y"].astype(int) * SIDE + events["x"], minlength=SIDE * SIDE)


def test_leak_rates_are_log_normal_of_the_same_mean_and_persistent() -> None:
    parameters = only(junction_leak={"k4_per_us": 1e-4}, leak_mismatch={"sigma": SIGMA})
    simulator = Simulator(SIDE, SIDE, parameters, seed=7)
    first, second = (counts(watch_still(simulator, 9, 5, 2, t)) for t in (0, 6_000_000))
    # 500 events in 5 s of each pixel, rounded to a whole number: 0.1 % where the spread is 23 %
    law = stats.norm(-(SIGMA**2) / 2, SIGMA)
    assert stats.kstest(np.log(first / 500), law.cdf).pvalue > 1e-4
    assert np.corrcoef(first, second)[0, 1] > 0.999
    assert abs(first.mean() / 500 - 1) < 5 * SIGMA / SIDE


def test_the_pattern_is_of_the_seed_and_only_of_junction_leak() -> None:
    def pattern(seed: int, **leak: object) -> np.ndarray:
        simulator = Simulator(SIDE, SIDE, only(leak_mismatch={"sigma": SIGMA}, **leak), seed=seed)
        return counts(watch_still(simulator, 100, 2, 2))

    one, again, other = (pattern(seed, junction_leak={"k4_per_us": 1e-4}) for seed in (1, 1, 2))
    assert (one == again).all()
    assert abs(np.corrcoef(one, other)[0, 1]) < 5 / SIDE
    even = pattern(1, parasitic_photocurrent={"k5_per_dn_us": 1e-6})
    assert np.ptp(even) <= 1
