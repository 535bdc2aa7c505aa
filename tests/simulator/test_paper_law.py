"""The paper's law: its polarity formula, and that it starts all pixels together."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.paper_law import on_probability

from .scenes import only, still, watch_still


@pytest.mark.parametrize("mu", [-2.0, -0.3, 0.0, 1e-12, 0.4, 3.0, 1e4])
@pytest.mark.parametrize(("up", "down"), [(1.0, 1.0), (0.3, 1.7), (1.0, 0.01)])
def test_polarity_is_the_exit_probability_of_brownian_motion(mu: float, up: float, down: float) -> None:
    """By the scale function exp(-2 mu x / sigma^2), integrated numerically."""
    sigma2 = 0.7
    below = quad(lambda x: math.exp(min(-2 * mu * (x + down) / sigma2, 700)), -down, 0)[0]
    whole = quad(lambda x: math.exp(min(-2 * mu * (x + down) / sigma2, 700)), -down, up, limit=500)[0]
    if mu < 1e3:
        assert on_probability(mu, sigma2, up, down) == pytest.approx(below / whole, rel=1e-6)
    else:
        assert on_probability(mu, sigma2, up, down) == 1.0


def test_without_noise_the_sign_of_the_drift_decides() -> None:
    assert [on_probability(mu, 0.0, 1.0, 1.0) for mu in (-1.0, 0.0, 1.0)] == [0.0, 0.5, 1.0]


def test_all_pixels_start_at_the_memorised_level_so_they_leak_together() -> None:
    """A known property of Algorithm 1; the exact law starts from the stationary one."""
    simulator = Simulator(30, 30, Parameters.of("paper"), law="paper", seed=1)
    events = watch_still(simulator, 128, 2, 240)
    assert len(events) == 900
    assert events["t"].std() < 10_000
    assert events["t"].mean() == pytest.approx(1.351e6, rel=0.01)


def test_noise_free_edges_are_integrate_and_fire() -> None:
    simulator = Simulator(5, 5, only(contrast_response={"k1": 5, "k2_dn": 20}), law="paper", seed=1)
    simulator.advance(still(0, 5, 5), 0)
    events = simulator.advance(still(60, 5, 5), 60_000)
    expected = np.arange(1, 6) * 10_000  # 5 * 60 / 50 = 6 thresholds in 60 ms; the sixth falls on the end
    assert sorted(set(events["t"].tolist())) == pytest.approx(expected.tolist(), abs=1)
    assert len(events) == 125
