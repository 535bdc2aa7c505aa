"""A noise without a name: ON and OFF events at rest by brightness."""

import pytest

from voltcam_simulator import Simulator

from ..scenes import only, watch_still

SIDE, SECONDS = 50, 10.0


@pytest.mark.parametrize("grey", [5.0, 60.0, 230.0])
def test_brownian_exits_of_both_polarities_at_the_rate_of_its_variance(grey: float) -> None:
    """From 0, Brownian motion leaves (-1, 1) after 1/sigma^2 on average, at either side alike."""
    parameters = only(residual_noise={"variance_per_us": 3e-6, "power": -0.5, "dark_dn": 20})
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=3), grey, SECONDS, 10)
    wanted = 3 * ((grey + 20) / 148) ** -0.5 * SECONDS * SIDE**2
    assert len(events) == pytest.approx(wanted, rel=0.02)  # more than 50 000 events
    assert events["p"].mean() == pytest.approx(0.5, abs=0.015)  # 5 sd
