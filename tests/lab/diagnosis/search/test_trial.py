"""Fitting an effect that the base parameters have nearly taken the place of."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.state import Search
from voltcam_lab.diagnosis.search.step import base_fitted, step_of, with_trials
from voltcam_lab.diagnosis.search.unlisted import residual_step
from voltcam_lab.statistics import FLOORS, PARTS, Values
from voltcam_simulator import Parameters

from ..made_rig import CATALOGUE, DEAD, MISMATCH, PATTERNS, START, MadeRig, logs

LEAK_PER_US = START.junction_leak.k4_per_us + 128 * START.parasitic_photocurrent.k5_per_dn_us
LIGHT = np.geomspace(0.05, 2, len(FLOORS))


def leaking(parameters: Parameters) -> Values:
    """Leaks by brightness, as their rates are: a root is nearly a part of k5's and of k4's."""
    drift = parameters.residual_drift
    per_us = (
        parameters.junction_leak.k4_per_us
        + 128 * parameters.parasitic_photocurrent.k5_per_dn_us * LIGHT
        + drift.per_us * LIGHT**drift.power
    )
    others = np.tensordot(10 * logs(parameters)[[0, 1, 2, 5]], PATTERNS[[0, 1, 2, 5]], 1)
    return 100 + others + 40 * per_us / LEAK_PER_US * np.maximum(FLOORS, 1) * np.ones((PARTS, 1))


def test_a_drift_that_the_leaks_have_taken_up_is_found_with_its_size_and_power() -> None:
    rig, hidden_per_us = MadeRig(leaking), -0.5 * LEAK_PER_US
    there = START.changed({"residual_drift": {"per_us": hidden_per_us, "power": 0.5}})
    data = leaking(there) + rig.noise(4711)
    search = Search(rig, data, ())
    trials = residual_step(search, base_fitted(search, Hypothesis(START))).trials
    best = trials[0]
    assert len({one.candidate.others["power"] for one in trials}) > 1, "each power is a form of its own"
    assert best.candidate.others["power"] == 0.5
    assert best.hypothesis.sizes()[0][0] == pytest.approx(hidden_per_us, rel=0.2)


def barred(parameters: Parameters) -> Values:
    """A base parameter takes an effect's place; on the way back to the camera file the effect turns round."""
    first, *others = logs(parameters)
    amount = (
        10 * parameters.threshold_mismatch.sigma * np.interp(first, [0.1, 0.3, 0.5, 0.7], [1, -3, -3, 0.3])
    )
    seen = np.tensordot([10 * first, *(10 * np.array(others))], PATTERNS[:6], 1)
    return 100 + seen + amount * (10 * PATTERNS[0] + PATTERNS[6])


def test_an_effect_is_fitted_from_the_camera_file_too_where_the_base_stands_in_for_it() -> None:
    rig = MadeRig(barred)
    data = barred(MISMATCH.on(START, (0.1,))) + rig.noise(4711)
    base = base_fitted(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert base.shift[0] > 0.7, "it stands in for the effect"
    search = Search(rig, data, CATALOGUE)
    best = with_trials(search, step_of(search, base)).trials[0]
    assert best.candidate == MISMATCH
    assert best.hypothesis.sizes()[0][0] == pytest.approx(0.1, rel=0.2)
    assert abs(best.hypothesis.shift[0]) < 0.1


def lost(parameters: Parameters) -> Values:
    """A base parameter takes an effect's place, and where it has gone the effect does nothing at all; what it
    cannot take up looks a little like another effect."""
    first, *others = logs(parameters)
    amount = 10 * parameters.threshold_mismatch.sigma * np.interp(first, [0.1, 0.3], [1, 0])
    seen = np.tensordot([10 * first, *(10 * np.array(others))], PATTERNS[:6], 1)
    dead = 100 * parameters.dead_pixels.fraction * (PATTERNS[6] + PATTERNS[7])
    return 100 + seen + amount * (12 * PATTERNS[0] + 0.8 * PATTERNS[6]) + dead


def test_an_effect_that_the_base_stands_in_for_is_looked_for_from_the_camera_file() -> None:
    rig = MadeRig(lost)
    data = lost(MISMATCH.on(START, (0.1,))) + rig.noise(4711)
    base = base_fitted(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert base.off_prior(DEFAULTS)
    search = Search(rig, data, CATALOGUE)
    best, *others = with_trials(search, step_of(search, base)).trials
    assert best.candidate == MISMATCH
    assert best.hypothesis.sizes()[0][0] == pytest.approx(0.1, rel=0.2)
    assert abs(best.hypothesis.shift[0]) < 0.1
    assert [one.candidate for one in others] == [DEAD]
