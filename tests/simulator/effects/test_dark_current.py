"""Dark current: light that is not there, more of it when warm."""

import math

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import only, still, watch_still


def light_dn(parameters: Parameters, grey: float) -> float:
    """What the pixels take for their light, by the leak that goes with it: 1 event a second for each DN."""
    leaky = parameters.changed({"parasitic_photocurrent": {"k5_per_dn_us": 1e-6}})
    return len(watch_still(Simulator(20, 20, leaky, seed=1), grey, 10, 2)) / 400 / 10


@pytest.mark.parametrize("grey", [0, 30])
def test_it_doubles_with_temperature_whatever_the_light(grey: float) -> None:
    dark = only(dark_current={"dark_dn": 3, "doubling_c": 8})
    for temperature_c, extra in ((25, 3), (33, 6), (17, 1.5), (49, 24)):
        warm = dark.changed({"temperature_c": temperature_c})
        assert light_dn(warm, grey) == pytest.approx(grey + extra, abs=0.03)


def test_dim_edges_lose_contrast_when_warm_and_bright_ones_do_not() -> None:
    dark = only(contrast_response={"k1": 100, "k2_dn": 1}, dark_current={"dark_dn": 3})
    for temperature_c, extra in ((25, 3), (57, 48)):
        for first, last in ((0, 5), (200, 250)):
            simulator = Simulator(20, 20, dark.changed({"temperature_c": temperature_c}), seed=1)
            simulator.advance(still(first, 20, 20), 0)
            events = simulator.advance(still(last, 20, 20), 1000)
            expected = 100 * math.log((last + extra + 1) / (first + extra + 1)) - 0.5
            assert len(events) / 400 == pytest.approx(expected, abs=5 * np.sqrt(1 / 6 / 400))


def test_it_follows_a_drifting_temperature() -> None:
    drifting = only(dark_current={"dark_dn": 4}, temperature_drift={"rate_c_per_s": 1.6})
    # doubles in 5 s and again in the next: the mean of 4 * 2^(t/5) over 10 s
    assert light_dn(drifting, 0) == pytest.approx(4 * 3 / (2 * math.log(2)), rel=0.01)


def test_it_is_a_million_at_most_however_warm() -> None:
    counts = []
    for dark_dn, first in ((1e4, 0.0), (0.0, 1e6)):
        parameters = only(
            contrast_response={"k1": 1000}, comparator={"theta_on": 0.01},
            dark_current={"dark_dn": dark_dn, "doubling_c": 1},
        )  # fmt: skip
        simulator = Simulator(20, 20, parameters.changed({"temperature_c": 100}), seed=1)
        simulator.advance(still(first, 20, 20), 0)
        counts.append(len(simulator.advance(still(first + 255, 20, 20), 1000)))
    assert counts[0] == counts[1] > 0
