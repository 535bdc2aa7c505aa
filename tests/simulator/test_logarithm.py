"""ln x of a plane against numpy's in double precision."""

import numpy as np

from voltcam_simulator.logarithm import add_logarithm


def test_it_is_numpy_s_within_its_error() -> None:
    x = np.exp(np.linspace(-60, 60, 20_001)).astype(np.float32)
    total = np.zeros_like(x)
    add_logarithm(x.copy(), np.float32(1), total)
    exact = np.log(x.astype(np.float64))
    assert (np.abs(total - exact) <= 2e-7 * np.maximum(1, np.abs(exact))).all()


def test_it_is_added_by_its_factor_and_ln_1_is_0() -> None:
    total = np.array([5.0, 5.0], np.float32)
    add_logarithm(np.array([1.0, np.e], np.float32), np.float32(-2), total)
    assert total[0] == 5
    assert abs(total[1] - 3) < 1e-6
