"""Input response: the light behind the grey levels of a video."""

import numpy as np
import pytest

from voltcam_simulator import Limits, Parameters, Simulator
from voltcam_simulator.effects.input_response import MOST_LIGHT_DN, InputResponse

from ..scenes import only


def light_by_column(gamma: float, black: float, ramp: np.ndarray, **ends: float) -> np.ndarray:
    """What pixels take for their light, by the leak that goes with it: 100 events a second for each DN."""
    response = {"gamma_exponent": gamma, "black_level_dn": black, **ends}
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


@pytest.mark.parametrize(("gamma", "black"), [(1, 0), (1, 16), (2.2, 0)])
def test_grey_levels_begin_at_a_pedestal_and_black_is_half_of_it(gamma: float, black: float) -> None:
    grey = np.array([0, black / 2, black, black + 0.5, black + 1, black + 2, 200])
    above = np.array([4, 4, 4, 6.5, 9, 10, 200 - black + 8])
    expected = 255 * (above / (255 - black)) ** gamma
    np.testing.assert_allclose(
        light_by_column(gamma, black, grey, pedestal_dn=8.0), expected, rtol=1e-4, atol=0.011
    )


@pytest.mark.parametrize(("gamma", "black"), [(1, 0), (1, 16), (2.2, 0)])
def test_white_and_brighter_stands_for_more_light(gamma: float, black: float) -> None:
    grey = np.array([0, 100, 119, 119.5, 120, 130])
    times = np.array([1, 1, 1, 1.5, 2, 2])
    expected = 255 * (times * np.maximum(grey - black, 0) / (255 - black)) ** gamma
    found = light_by_column(gamma, black, grey, white_level_dn=120.0, highlight=2.0)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=0.011)


@pytest.mark.parametrize(
    ("gamma", "highlight", "grey"), [(11, 10, 255), (11, 1, 1e12), (1, 10, 1e12), (0.2, 10, 1e12)]
)
def test_light_has_an_end_whatever_is_set(gamma: float, highlight: float, grey: float) -> None:
    """Beyond it voltages would be no numbers: at 1e25 DN a kernel wrote where it must not."""
    response = {"gamma_exponent": gamma, "highlight": highlight, "white_level_dn": 2.0}
    parameters = Parameters.of("typical").changed({"input_response": response})
    frames = np.array([[[0.0, 1.0], [100.0, grey]], [[grey, grey], [grey, 0.0]]])
    camera = Simulator(2, 2, parameters)
    events = [camera.advance(frames[i % 2], 1000 * i, Limits(most_events=100_000)) for i in range(4)]
    assert all((np.diff(some["t"]) >= 0).all() for some in events)
    light = InputResponse(**response).light_of(np.full((1, 2), grey, np.float32))
    assert (light <= MOST_LIGHT_DN).all()
