"""ON/OFF asymmetry: unequal thresholds show at any speed."""

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import PIXELS, only, rate_hz, still


@pytest.mark.parametrize("rise_us", [1000, 100_000, 10_000_000])
def test_on_and_off_counts_are_in_the_ratio_of_the_thresholds_at_all_speeds(rise_us: int) -> None:
    thresholds = {"theta_on": 0.8, "theta_off": 1.2}
    simulator = Simulator(40, 40, only(contrast_response={"k1": 40}, comparator=thresholds), seed=1)
    simulator.advance(still(10, 40, 40), 0)
    counts = np.zeros(2)
    for k in range(1, 9):
        events = simulator.advance(still(200 if k % 2 else 10, 40, 40), k * rise_us)
        counts += (events["p"].sum(), (~events["p"]).sum())
    # 79.7 thresholds up and down: hysteresis takes at most one event of each, of 100 and of 66
    assert counts[0] / counts[1] == pytest.approx(1.2 / 0.8, rel=0.01)
    assert counts[0] / 4 / 1600 == pytest.approx(40 * np.log(220 / 30) / 0.8, rel=0.015)


def test_thresholds_set_the_polarity_ratio_of_noise() -> None:
    parameters = only(leak_noise={"k6": 1e-3}, comparator={"theta_on": 2.0, "theta_off": 0.5})
    on, off = rate_hz(parameters, 50, 10)
    # leaves (-1/2, 2) at the top with probability 1/5, after a mean time of 2 * 1/2 / sigma^2
    assert on / (on + off) == pytest.approx(0.2, abs=0.01)
    assert on + off == pytest.approx(PIXELS, rel=0.03)
