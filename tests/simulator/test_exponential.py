"""e^x of a plane against numpy's in double precision."""

import numpy as np

from voltcam_simulator.exponential import exponential


def test_it_is_numpy_s_within_its_error() -> None:
    x = np.concatenate([np.linspace(-87, 88, 20_001), [0.0]]).astype(np.float32)
    found = x.copy()
    exponential(found)
    exact = np.exp(x.astype(np.float64))
    assert (np.abs(found - exact) <= 2e-7 * (1 + np.abs(x)) * exact).all()
    assert found[-1] == 1


def test_what_no_float_can_hold_is_held_at_the_ends() -> None:
    x = np.array([-1e30, -87, 88, 1e30], np.float32)
    exponential(x)
    assert x[0] == x[1] > 0
    assert x[3] == x[2] < np.inf
