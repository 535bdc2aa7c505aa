"""Input response: the light behind the grey levels of a video."""

import numpy as np
import pytest

from voltcam_simulator import Simulator

from ..scenes import only


def light_by_column(gamma: float, black: float, ramp: np.ndarray) -> np.ndarray:
    """What pixels take for their light, by the leak that goes with it: 100 events a second for each DN."""
    response = {"gamma_exponent": gamma, "black_level_dn": black}
    parameters = only(parasitic_photocurrent={"k5_per_dn_us": 1e-4}, input_response=response)
    simulator = Simulator(ramp.size, 2, parameters, seed=1)
    frame = np.tile(ramp, (2, 1))
    events = np.concatenate([simulator.advance(frame, t) for t in (0, 300_000, 1_000_000)])
    return np.bincount(events["x"], minlength=ramp.size) / 2 / 100


@pytest.mark.parametrize(("gamma", "black"), [(2.2, 0), (2.2, 16), (0.45, 0), (1, 16), (5, 0), (0.2, 50)])
def test_grey_levels_become_light(gamma: float, black: float) -> None:
    ramp = np.arange(256, dtype=np.uint8)
    expected = 255 * np.clip((np.arange(256) - black) / (255 - black), 0, None) ** gamma
    np.testing.assert_allclose(light_by_column(gamma, black, ramp), expected, rtol=1e-4, atol=0.011)


def test_brighter_than_white_and_between_grey_levels() -> None:
    ramp = np.array([0.25, 300.5, 500])
    expected = 255 * (ramp / 255) ** 2.2
    np.testing.assert_allclose(light_by_column(2.2, 0, ramp), expected, rtol=1e-4, atol=0.011)
