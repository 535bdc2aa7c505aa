"""The score test: gains and p-values."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.robust import mean_huber
from voltcam_lab.diagnosis.search.screen import Screen, Signature, screen_of
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import TwinSpread, flat, spread_of
from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import setting_of
from voltcam_simulator import Parameters

from ..made_rig import DEAD_TIME, MISMATCH, START

TWINS = 28
LIGHT_GAIN = DEFAULTS.score_test.light_gain


def screen(gains: np.ndarray) -> Screen:
    """One whose twins gain that."""
    none = np.zeros((4, 1))
    spread = TwinSpread(none, none, none, none, [none] * len(gains), none[..., None], 4)
    return Screen(Hypothesis(Parameters()), spread, none[..., None], (), gains, DEFAULTS)


def test_p_values_are_uniform_where_light_adds_to_the_gain() -> None:
    """Recordings gain as twins do and, of open light, a normal error's square. Wrong: 1e-4."""
    rng = np.random.default_rng(3)
    p_values = [
        screen(rng.gumbel(3, 3, TWINS)).p_value(rng.gumbel(3, 3) + LIGHT_GAIN * rng.chisquare(1))
        for _ in range(400)
    ]
    assert stats.kstest(p_values, "uniform").pvalue > 1e-4
    assert stats.binomtest(sum(p <= 0.01 for p in p_values), 400, 0.01).pvalue > 1e-4


def test_guessed_light_adds_more_to_a_gain_than_light_on_a_curve() -> None:
    """The same gain is so more likely where nothing is missing."""
    curve = screen(np.random.default_rng(4).gumbel(3, 3, TWINS))
    guessed = replace(curve, light_gain=DEFAULTS.score_test.guessed_light_gain)
    assert guessed.p_value(40.0) > 5 * curve.p_value(40.0)


def test_a_larger_gain_is_less_likely_and_beyond_all_twins_still_so() -> None:
    twins = np.random.default_rng(4).gumbel(3, 3, TWINS)
    p_values = np.array([screen(twins).p_value(gain) for gain in np.arange(0.0, 400.0, 5.0)])
    assert (np.diff(p_values) <= 0).all()
    assert p_values[0] > 0.9
    assert screen(twins).p_value(screen(twins).gain_of_chance) == pytest.approx(0.01)
    assert p_values[-1] < 1e-6


def test_a_delay_that_light_may_stand_for_is_no_effects_gain() -> None:
    """One effect does what a delay does, one something else. Of a delay of two sd all but its prior's cost,
    2^2/2, is taken up; one of 20 sd is no error of the light."""
    rng, size = np.random.default_rng(5), DEAD_TIME.sizes[0]
    delay, other, noise = 5 * rng.standard_normal((3, 4, 300))
    one = np.ones((4, 300))
    spread = TwinSpread(one, one, one, one, [], np.zeros((4, 300, 6)), 4)
    base = np.concatenate([np.zeros((4, 300, 6)), np.stack([delay, noise], axis=-1)], axis=-1)
    signatures = (Signature(DEAD_TIME, size, 10 * delay), Signature(MISMATCH, size, other))
    screen = Screen(Hypothesis(Parameters()), spread, base, signatures, np.empty(0), DEFAULTS)
    assert screen.gains(flat(2 * delay)).max() < 2.1
    assert screen.gains(flat(20 * delay))[0] > 100
    assert screen.gains(flat(2 * delay + noise)).max() < 2.1
    both = screen.gains(flat(2 * delay + other))
    assert both[1] > 100 > 3 > both[0]


def test_light_that_is_noisier_than_was_told_is_mostly_taken_up() -> None:
    """Cameras without any effect saw light whose errors are `noisier` times as large as what twins saw. Four
    runs for each column leave chance in it, sixteen half of that."""
    settings = replace(DEFAULTS, runs=replace(DEFAULTS.runs, fitting=range(16)))
    t_us = np.arange(0, 2_000_001, 40_000)
    grey = 100 + 60 * np.sin(6e-6 * np.pi * t_us[:, None, None] + np.arange(16) * 0.4 + np.zeros((12, 1)))
    scene = scene_of(grey.astype(np.float32), t_us, "cubic")
    rig, hypothesis = Rig(setting_of(scene, t_us, parameters=START)), Hypothesis(START)
    spread = spread_of(rig, hypothesis, range(28), DEFAULTS)
    seen = screen_of(rig, hypothesis, spread, (MISMATCH,), settings)
    recorded = rig.means([START], range(100, 112), noisier=True)[0]
    z = flat((recorded - spread.mean) / spread.inflated_sd)
    own = seen.own(z)
    assert own.gain / z.size > 0.75 * mean_huber(z, DEFAULTS.huber_z) > 0.2
    assert own.x[-1] == pytest.approx(1, abs=0.3)
    assert np.abs(own.x[:-1]).max() < 0.1
