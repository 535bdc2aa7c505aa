"""Fitting an effect that the base parameters have nearly taken the place of."""

import numpy as np
import pytest

from voltcam_lab.battery import FLOORS, PARTS
from voltcam_lab.diagnosis.model import Model
from voltcam_lab.diagnosis.rig import Values
from voltcam_lab.diagnosis.search import base_fitted
from voltcam_lab.diagnosis.unlisted import residual_step
from voltcam_simulator import Parameters

from .made_rig import PATTERNS, START, MadeRig, logs

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
    trials = residual_step(rig, base_fitted(rig, Model(START), data), data).trials
    best = trials[0]
    assert len({one.candidate.others["power"] for one in trials}) > 1, "each power is a form of its own"
    assert best.candidate.others["power"] == 0.5
    assert best.model.sizes()[0][0] == pytest.approx(hidden_per_us, rel=0.2)
