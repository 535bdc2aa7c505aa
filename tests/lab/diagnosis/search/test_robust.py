"""Robust linear fits."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.robust import huber, mean_huber, robust_fit
from voltcam_lab.diagnosis.search.settings import DEFAULTS

HUBER_Z, ROUNDS = DEFAULTS.huber_z, DEFAULTS.fit.reweightings


def test_loss_is_half_the_square_near_zero_and_linear_far_out() -> None:
    assert huber(np.array([0.01]), HUBER_Z) == pytest.approx(0.5e-4, rel=1e-4)
    assert huber(np.array([1e6]), HUBER_Z) == pytest.approx(HUBER_Z * 1e6, rel=1e-4)


def test_gap_of_chance_alone_is_a_little_less_than_a_half() -> None:
    z = np.random.default_rng(1).standard_normal(100_000)
    assert mean_huber(z, HUBER_Z) == pytest.approx(
        0.486, abs=0.01
    )  # 0.5 (1 - 3/(4 25)) to first order, +- 5 sd


def test_amounts_are_found_in_spite_of_outliers() -> None:
    rng = np.random.default_rng(2)
    columns = rng.standard_normal((500, 3))
    z = columns @ [1.0, -2.0, 0.5] + 0.1 * rng.standard_normal(500)
    z[:25] += 400
    found = robust_fit(z, columns, np.full(3, 10.0), HUBER_Z, rounds=30)
    least_squares = np.linalg.lstsq(columns, z, rcond=None)[0]
    assert found.x == pytest.approx([1, -2, 0.5], abs=0.2)
    assert abs(least_squares - [1, -2, 0.5]).max() > 1  # what robustness is for
    assert found.gain > 0


def test_the_prior_holds_what_the_data_do_not_say() -> None:
    columns = np.column_stack([np.ones(50), np.zeros(50)])
    found = robust_fit(np.full(50, 0.2), columns, np.array([1.0, 1.0]), HUBER_Z, ROUNDS)
    assert found.x[0] == pytest.approx(0.2, rel=0.05)
    assert found.x[1] == 0
