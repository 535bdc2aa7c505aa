"""A drift without a name: rates at rest by brightness and place."""

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import only, watch_still

SIDE, SECONDS = 40, 20.0


@pytest.mark.parametrize("power", [-1.0, 0.0, 0.5])
@pytest.mark.parametrize("grey", [12.0, 128.0, 230.0])
def test_rate_goes_with_the_power_of_brightness(power: float, grey: float) -> None:
    parameters = only(residual_drift={"per_us": 2e-6, "power": power, "dark_dn": 20})
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=1), grey, SECONDS, 5)
    assert events["p"].all()
    # without noise each pixel fires evenly, phases uniform: counts off by less than one event a pixel
    wanted = 2 * ((grey + 20) / 148) ** power * SECONDS
    assert len(events) / SIDE**2 == pytest.approx(wanted, abs=5 * 0.5 / SIDE)


def test_a_negative_one_gives_off_events() -> None:
    parameters = only(residual_drift={"per_us": -2e-6})
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=1), 128, SECONDS, 5)
    assert len(events) > 0
    assert not events["p"].any()


def test_it_grows_across_and_down_the_image() -> None:
    parameters = only(residual_drift={"per_us": 2e-6, "across": 0.5, "down": -0.5})
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=1), 128, 200.0, 5)
    by_column = np.bincount(events["x"], minlength=SIDE) / SIDE
    by_row = np.bincount(events["y"], minlength=SIDE) / SIDE
    place = np.linspace(-1, 1, SIDE)
    assert by_column == pytest.approx(400 * (1 + 0.5 * place), abs=1)
    assert by_row == pytest.approx(400 * (1 - 0.5 * place), abs=1)
