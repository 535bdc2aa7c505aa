"""Fits of a hypothesis to measured statistics."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.fit import fitted_by_simulation
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.state import Search
from voltcam_lab.statistics import FLOORS, PARTS, Values
from voltcam_simulator import Parameters

from ..made_rig import DEAD_TIME, PATTERNS, START, MadeRig, logs, response

V = np.broadcast_to(np.maximum(FLOORS, 1.0), (PARTS, len(FLOORS)))


def test_base_parameters_are_found() -> None:
    truth = (0.3, -0.2, 0.1, 0.25, -0.3, 0.05)
    rig = MadeRig()
    data = response(Hypothesis(START, shift=truth).parameters()) + rig.noise(99)
    found, mean = fitted_by_simulation(Search(rig, data, ()), Hypothesis(START), V, rounds=2)
    assert found.shift == pytest.approx(truth, abs=0.02)
    assert np.abs((data - mean) / V).mean() < 1.1


def valley(parameters: Parameters) -> Values:
    """A leak stands in for the dead time, along a bend: sharp statistics see what they do together."""
    amount, leak = np.log(parameters.refractory_period.period_us / 1000), logs(parameters)[3]
    seen = 100 + 0.5 * amount * PATTERNS[6] + 0.05 * leak * PATTERNS[3]
    seen[:, :20] += 60 * (leak - np.tanh(amount))
    return seen


def test_the_size_of_an_effect_is_found_along_a_curved_valley() -> None:
    rig = MadeRig(valley)
    start = Hypothesis(START).with_effect(DEAD_TIME, (1000.0,))
    truth = start.parameters((0, 0, 0, np.tanh(1.0), 0, 0, 1.0))
    search = Search(rig, valley(truth) + rig.noise(99), ())
    found, _ = fitted_by_simulation(search, start, V, rounds=5)
    assert found.parameters().refractory_period.period_us == pytest.approx(2718, rel=0.15)
