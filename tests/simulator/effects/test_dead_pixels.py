"""Dead pixels: silent, whatever happens, and their neighbours are not."""

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Law, Simulator

from ..scenes import only, still

SIDE = 80


def silent(fraction: float, law: Law, seed: int = 1) -> np.ndarray:
    """Pixels without an event in two strong flashes, with noise, leak, a dead time and kicks."""
    parameters = only(
        contrast_response={"k1": 10}, leak_noise={"k6": 1e-3}, junction_leak={"k4_per_us": 1e-5},
        refractory_period={"period_us": 100}, aps_coupling={"readout_kick": 0.1},
        threshold_mismatch={"sigma": 0.1}, dead_pixels={"fraction": fraction},
    )  # fmt: skip
    simulator = Simulator(SIDE, SIDE, parameters, law=law, seed=seed)
    simulator.advance(still(10, SIDE, SIDE), 0)
    spoke = np.zeros((SIDE, SIDE), bool)
    for k, grey in enumerate((200, 200, 10, 10)):
        events = simulator.advance(still(grey, SIDE, SIDE), (k + 1) * 50_000)
        spoke[events["y"], events["x"]] = True
    return ~spoke


@pytest.mark.parametrize("law", ["exact", "paper"])
def test_the_share_of_silent_pixels(law: Law) -> None:
    assert silent(0, law).sum() == 0
    assert silent(1, law).all()
    some = silent(0.05, law)
    assert stats.binomtest(int(some.sum()), SIDE**2, 0.05).pvalue > 1e-4


def test_they_are_the_same_at_every_start_and_others_with_another_seed() -> None:
    assert (silent(0.05, "exact") == silent(0.05, "paper")).all()
    assert (silent(0.05, "exact") != silent(0.05, "exact", seed=2)).any()
