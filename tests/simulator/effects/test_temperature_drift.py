"""Temperature drift: the rate of ON events at rest follows Arrhenius' law through time."""

import numpy as np
import pytest

from voltcam_simulator import Simulator
from voltcam_simulator.effects.junction_leak import arrhenius

from ..scenes import only, watch_still

SIDE, LEAK = 24, 1e-4


def rates(drift: dict[str, float], seconds: int, leak: float = LEAK) -> np.ndarray:
    """Events of each pixel in each second."""
    parameters = only(junction_leak={"k4_per_us": leak}, temperature_drift=drift)
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=3), 9, seconds, 20, t0_us=10**15)
    assert events["p"].all()
    # counts of clocks with uniform phases: each is within one of its mean, so the mean of 576 spreads by 0.02
    return np.bincount((events["t"] - 10**15) // 1_000_000, minlength=seconds)[:seconds] / SIDE**2


@pytest.mark.parametrize("rate", [2.0, -2.0])
def test_leak_follows_a_warming_die(rate: float) -> None:
    warming = 25 + rate * (np.arange(1000) + 0.5) / 100
    expected = LEAK * 1e6 * np.array([arrhenius(t, 0.56) for t in warming]).reshape(10, 100).mean(axis=1)
    np.testing.assert_allclose(rates({"rate_c_per_s": rate}, 10), expected, atol=0.15)


def test_a_swing_comes_back() -> None:
    measured = rates({"amplitude_c": 10, "period_s": 8}, 16)
    swing = 25 + 10 * np.sin(2 * np.pi * (np.arange(1600) + 0.5) / 800)
    expected = LEAK * 1e6 * np.array([arrhenius(t, 0.56) for t in swing]).reshape(16, 100).mean(axis=1)
    np.testing.assert_allclose(measured, expected, atol=0.15)
    assert measured.max() > 2 * measured.min()


def test_it_stops_where_no_camera_works() -> None:
    measured = rates({"rate_c_per_s": 10}, 14, leak=1e-6)
    np.testing.assert_allclose(measured[10:], arrhenius(125, 0.56), atol=0.15)


def test_it_begins_when_it_is_set_and_what_else_is_set_leaves_it_alone() -> None:
    light, before = np.full((SIDE, SIDE), 9.0), only(junction_leak={"k4_per_us": LEAK})
    warming = before.changed({"temperature_drift": {"rate_c_per_s": 2.0}})
    simulator, counts = Simulator(SIDE, SIDE, before, seed=3), []
    simulator.advance(light, 0)
    for second in range(1, 11):
        if second == 7:
            simulator.parameters = warming
        if second == 9:
            simulator.parameters = warming.changed({"reset_noise": {"sigma": 0.01}})
        counts.append(len(simulator.advance(light, second * 1_000_000)) / SIDE**2)
    temperature_c = 25 + 2.0 * np.maximum(np.arange(10) + 0.5 - 6, 0)  # of each second, half way
    expected = [LEAK * 1e6 * arrhenius(t, 0.56) for t in temperature_c]
    np.testing.assert_allclose(counts, expected, atol=1.1)  # an event each, and resets' noise
