"""The score test: gains and p-values."""

import numpy as np
from scipy import stats

from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.screen import Screen, Signature, light_gains
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import TwinSpread, flat
from voltcam_simulator import Parameters

from ..made_rig import DEAD_TIME, MISMATCH

TWINS = 28
LIGHT_GAIN = DEFAULTS.score_test.light_gain


def screen(gains: np.ndarray) -> Screen:
    """One whose twins gain that."""
    none = np.zeros((4, 1))
    spread = TwinSpread(none, none, none, none, [none] * len(gains), none[..., None], 4)
    null = np.add.outer(gains, light_gains(DEFAULTS.score_test)).ravel()
    return Screen(Hypothesis(Parameters()), spread, none[..., None], (), null, DEFAULTS)


def test_p_values_are_uniform_where_light_adds_to_the_gain() -> None:
    """Recordings gain as twins do and, of open light, an exponential of mean LIGHT_GAIN. Wrong: 1e-4."""
    rng = np.random.default_rng(3)
    p_values = [
        screen(rng.gumbel(3, 3, TWINS)).p_value(rng.gumbel(3, 3) + rng.exponential(LIGHT_GAIN))
        for _ in range(400)
    ]
    assert stats.kstest(p_values, "uniform").pvalue > 1e-4
    assert stats.binomtest(sum(p <= 0.01 for p in p_values), 400, 0.01).pvalue > 1e-4


def test_a_larger_gain_is_less_likely_and_beyond_all_twins_still_so() -> None:
    twins = np.random.default_rng(4).gumbel(3, 3, TWINS)
    p_values = np.array([screen(twins).p_value(gain) for gain in np.arange(0.0, 200.0, 5.0)])
    assert (np.diff(p_values) <= 0).all()
    assert p_values[0] > 0.9
    assert p_values[-1] < 1e-6


def test_a_delay_that_light_may_stand_for_is_no_effects_gain() -> None:
    """One effect does what a delay does, one something else. Of a delay of two sd all but its prior's cost,
    2^2/2, is taken up; one of 20 sd is no error of the light."""
    rng, size = np.random.default_rng(5), DEAD_TIME.sizes[0]
    delay, other = 5 * rng.standard_normal((2, 4, 300))
    one = np.ones((4, 300))
    spread = TwinSpread(one, one, one, one, [], np.zeros((4, 300, 6)), 4)
    base = np.concatenate([np.zeros((4, 300, 6)), delay[..., None]], axis=-1)
    signatures = (Signature(DEAD_TIME, size, 10 * delay), Signature(MISMATCH, size, other))
    screen = Screen(Hypothesis(Parameters()), spread, base, signatures, np.empty(0), DEFAULTS)
    assert screen.gains(flat(2 * delay)).max() < 2.1
    assert screen.gains(flat(20 * delay))[0] > 100
    both = screen.gains(flat(2 * delay + other))
    assert both[1] > 100 > 3 > both[0]
