"""How often so much is gained where nothing is missing."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from voltcam_lab.diagnosis.search.chance import RARE, Chance, of_two_views

TWINS, LIGHT_GAIN = 28, 3.0


def chance(seed: int) -> Chance:
    return Chance(np.random.default_rng(seed).gumbel(3, 3, TWINS), LIGHT_GAIN)


def test_p_values_are_uniform_where_light_adds_to_the_gain() -> None:
    """Recordings gain as twins do and, of open light, a normal error's square. Wrong: 1e-4."""
    rng = np.random.default_rng(3)
    p_values = [
        Chance(rng.gumbel(3, 3, TWINS), LIGHT_GAIN).p_value(rng.gumbel(3, 3) + LIGHT_GAIN * rng.chisquare(1))
        for _ in range(400)
    ]
    assert stats.kstest(p_values, "uniform").pvalue > 1e-4
    assert stats.binomtest(sum(p <= 0.01 for p in p_values), 400, 0.01).pvalue > 1e-4


def test_the_more_light_adds_the_likelier_is_a_gain_where_nothing_is_missing() -> None:
    little = chance(4)
    assert replace(little, light_gain=12.0).p_value(40.0) > 5 * little.p_value(40.0)
    assert little.p_value(40.0) > 5 * replace(little, light_gain=0.0).p_value(40.0)


def test_a_larger_gain_is_less_likely_and_beyond_all_twins_still_so() -> None:
    twins = chance(4)
    p_values = np.array([twins.p_value(gain) for gain in np.arange(0.0, 400.0, 5.0)])
    assert (np.diff(p_values) <= 0).all()
    assert p_values[0] > 0.9
    assert twins.p_value(twins.gain_of(0.01)) == pytest.approx(0.01)
    assert p_values[-1] < 1e-6


def test_twins_that_gain_nothing_do_not_make_any_gain_a_wonder() -> None:
    """Halves of squared normal numbers have a tail like e^-g, and so has the largest of many."""
    none = Chance(np.zeros(TWINS))
    assert none.p_value(1.0) > 0.1
    assert none.p_value(20.0) == pytest.approx(np.exp(-20 - np.euler_gamma), rel=0.01)


def test_of_two_views_the_smaller_p_value_is_uniform() -> None:
    """Of independent ones; and of a second view with a lump of large ones. Wrong: 1e-4."""
    p_values = np.random.default_rng(8).random((2, 2000))
    for second in (p_values[1], np.where(p_values[1] > RARE, 0.45, p_values[1])):
        both = [
            min(of_two_views(a, second=False), of_two_views(b, second=True))
            for a, b in zip(p_values[0], second, strict=True)
        ]
        assert stats.kstest(both, "uniform").pvalue > 1e-4
    assert of_two_views(0.004, second=True) == pytest.approx(0.008, rel=0.01)
