"""The score test: gains, and p-values by two views of a recording."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.rig import Rig
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.robust import mean_huber
from voltcam_lab.diagnosis.search.screen import Screen, Signature, screen_of
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import TwinSpread, flat, spread_of
from voltcam_lab.light.scene import scene_of
from voltcam_lab.statistics import IN_ANY_LIGHT, setting_of
from voltcam_simulator import Parameters

from ..made_rig import DEAD_TIME, MISMATCH, START


def test_a_delay_that_light_may_stand_for_is_no_effects_gain() -> None:
    """One effect does what a delay does, one something else. Of a delay of two sd all but its prior's cost,
    2^2/2, is taken up; one of 20 sd is no error of the light."""
    rng, size = np.random.default_rng(5), DEAD_TIME.sizes[0]
    delay, other, noise = 5 * rng.standard_normal((3, 4, 300))
    one = np.ones((4, 300))
    spread = TwinSpread(one, one, one, one, [], np.zeros((4, 300, 6)), 4, 0 * one)
    base = np.concatenate([np.zeros((4, 300, 6)), np.stack([delay, noise], axis=-1)], axis=-1)
    signatures = (Signature(DEAD_TIME, size, 10 * delay), Signature(MISMATCH, size, other))
    screen = Screen(Hypothesis(Parameters()), spread, base, signatures, DEFAULTS, np.ones(300, np.bool_))
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
    chance_alone = np.sqrt(spread.sd**2 - spread.light**2)
    assert 0.75 * mean_huber(flat((recorded - spread.mean) / chance_alone), DEFAULTS.huber_z) > 0.2
    z = flat((recorded - spread.mean) / spread.inflated_sd)
    own = seen.own(z)
    assert mean_huber(z, DEFAULTS.huber_z) - own.gain / z.size < 0.03
    assert 0.4 < own.x[-1] < 1.2
    assert np.abs(own.x[:-1]).max() < 0.1


def test_what_statistics_of_any_light_show_is_not_held_against_what_light_may_add() -> None:
    """Of two effects of one gain, the one that light has no part in is the surer: the other is no surprise
    where light is guessed. Each has 60 of loss."""
    n, size = len(IN_ANY_LIGHT), DEAD_TIME.sizes[0]
    one, none = np.ones((4, n)), np.zeros((4, n))
    twins = list(np.random.default_rng(6).standard_normal((28, 4, n)))
    spread = TwinSpread(none, one, none, one, twins, np.zeros((4, n, 6)), 4, none)
    known, dead = np.where(IN_ANY_LIGHT, 0, one), np.where(IN_ANY_LIGHT, one, 0)
    columns = [5 * each / np.linalg.norm(each) for each in (known, dead)]
    signatures = Signature(DEAD_TIME, size, columns[0]), Signature(MISMATCH, size, columns[1])
    every = np.ones(n, np.bool_)
    seen = Screen(
        Hypothesis(START), spread, np.zeros((4, n, 8)), signatures, DEFAULTS, every, light_gain=10.0
    )
    by_light, by_itself = (10 * column / np.linalg.norm(flat(column)) for column in columns)
    in_any_light = seen.in_any_light
    assert seen.gains(seen.flat(by_light)).argmax() == 0
    assert in_any_light.gains(in_any_light.flat(by_light)).max() < 1e-9
    assert seen.gains(seen.flat(by_itself)).max() == pytest.approx(
        seen.gains(seen.flat(by_light)).max(), rel=0.3
    )
    for what in (by_light, by_itself):
        assert seen.p_value(seen.flat(what)) > 0.01
    assert in_any_light.p_value(in_any_light.flat(by_itself)) < 1e-7
    assert in_any_light.p_value(in_any_light.flat(by_light)) > 0.5
