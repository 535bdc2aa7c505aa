"""Threshold mismatch: pixels that always give more events than others, when anything moves."""

import numpy as np
from scipy import stats

from voltcam_simulator import Parameters, Simulator

from ..scenes import only, still

SIDE = 60
SWING = 100 * np.log(220 / 30)  # thresholds from 10 to 200 DN


def cycles(parameters: Parameters, seed: int, number: int = 2) -> np.ndarray:
    """(number, 2, pixels) counts of ON and OFF events in cycles from 10 to 200 DN and back."""
    simulator = Simulator(SIDE, SIDE, parameters, seed=seed)
    simulator.advance(still(10, SIDE, SIDE), 0)
    result = np.zeros((number, 2, SIDE * SIDE))
    for step in range(2 * number):
        grey, t_us = (200, 10)[step % 2], (step + 1) * 100_000
        events = simulator.advance(still(grey, SIDE, SIDE), t_us)
        result[step // 2, step % 2] = np.bincount(
            events["y"].astype(int) * SIDE + events["x"], minlength=SIDE * SIDE
        )
    return result


def test_event_counts_spread_by_pixel_and_polarity_and_stay() -> None:
    parameters = only(contrast_response={"k1": 100}, threshold_mismatch={"sigma": 0.1})
    (on, off), (on_again, off_again) = cycles(parameters, seed=8)
    # counts are swing/threshold to one of about 200, where thresholds spread by 10 %
    for count in (on_again, off_again):
        assert stats.kstest(SWING / (count + 0.5), stats.norm(1, 0.1).cdf).pvalue > 1e-4
    assert np.corrcoef(on, on_again)[0, 1] > 0.99
    assert np.corrcoef(off, off_again)[0, 1] > 0.99
    assert abs(np.corrcoef(on_again, off_again)[0, 1]) < 5 / SIDE


def test_without_it_all_pixels_are_alike() -> None:
    assert np.ptp(cycles(only(contrast_response={"k1": 100}), seed=8)[1]) <= 2


def test_thresholds_stay_positive() -> None:
    parameters = only(contrast_response={"k1": 100}, threshold_mismatch={"sigma": 0.5})
    on, off = cycles(parameters, seed=9)[1]
    assert max(on.max(), off.max()) <= SWING / 0.1 + 2
    assert stats.binomtest(int((on > SWING / 0.101).sum()), SIDE**2, stats.norm.cdf(-1.8)).pvalue > 1e-4
