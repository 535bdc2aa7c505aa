"""Log ratios of densities that are known: the fit finds them, and gains what it should."""

import numpy as np
import pytest

from voltcam_lab.dependence.additive import Additive, fit, gain

RATIO = np.array([0.8, -0.3, 0.0, -1.2])
OTHER = np.array([-0.5, 0.5])
COUNT = 60_000


def drawn(seed: int) -> tuple[list[np.ndarray], np.ndarray]:
    """Events of which the log odds of being real are RATIO + OTHER, but for a constant."""
    rng = np.random.default_rng(seed)
    first, second = rng.integers(0, 4, COUNT), rng.integers(0, 2, COUNT)
    return [first, second], rng.random(COUNT) < 1 / (1 + np.exp(-(RATIO[first] + OTHER[second])))


def test_functions_are_found_and_gain_what_the_truth_does() -> None:
    """60 000 events: bins are known to .02, and 5 of these are asked for."""
    covariates, real = drawn(1)
    model = fit(covariates, [4, 2], real)
    for found, wanted in zip(model.functions, (RATIO, OTHER), strict=True):
        assert np.diff(found) == pytest.approx(np.diff(wanted), abs=0.1)
    fresh, label = drawn(2)
    ratio = model.log_ratio(fresh, COUNT)
    prior = np.log(real.mean() / (1 - real.mean()))
    truth = RATIO[fresh[0]] + OTHER[fresh[1]] - prior
    assert gain(ratio, label) == pytest.approx(gain(truth, label), abs=2e-3)
    assert gain(ratio, label) > 0.05


def test_what_tells_nothing_gains_nothing_held_out() -> None:
    rng = np.random.default_rng(3)
    bins, real = [rng.integers(0, 40, COUNT)], rng.random(COUNT) < 0.3
    half = np.arange(COUNT) < COUNT // 2
    model = fit([bins[0][half]], [40], real[half])
    assert abs(gain(model.log_ratio([bins[0][~half]], int((~half).sum())), real[~half])) < 2e-3


def test_a_function_is_added_to_what_is_known() -> None:
    covariates, real = drawn(5)
    first = fit(covariates[:1], [4], real)
    known = first.log_ratio(covariates[:1], COUNT)
    both = first.and_then(fit(covariates[1:], [2], real, known))
    assert isinstance(both, Additive)
    assert gain(both.log_ratio(covariates, COUNT), real) > gain(known, real) + 0.02
