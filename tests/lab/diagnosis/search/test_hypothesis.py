"""Camera files with effects added and parameters changed."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.catalogue.entries import catalogue
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis, start_of
from voltcam_lab.diagnosis.search.settings import DEFAULTS, SearchSettings
from voltcam_lab.diagnosis.search.settings_fit import Priors
from voltcam_simulator import Parameters

from ..made_rig import START, made_clues

CLUES = made_clues()


def test_a_camera_file_without_a_leak_is_not_one_of_another_camera() -> None:
    """It has nothing to be so many times of; one with a leak is."""
    far = (0.0, 0.0, 0.0, 0.0, 2.0, 0.0)
    assert Hypothesis(START, (), far).far_from_file(DEFAULTS) == {"k5_per_dn_us": pytest.approx(np.exp(2))}
    assert not Hypothesis(Parameters.of("ideal"), (), far).far_from_file(DEFAULTS)


def test_a_hypothesis_knows_its_base_and_its_effects() -> None:
    start = Parameters.of("paper")
    dead_time = next(one for one in catalogue(CLUES) if one.effect == "refractory_period")
    model = Hypothesis(start).with_effect(dead_time, (1000.0,))
    moved = model.parameters([0.1, 0, 0, 0, 0, 0, 0.2])
    assert moved.contrast_response.k1 == pytest.approx(start.contrast_response.k1 * 1.10517, rel=1e-4)
    assert moved.refractory_period.period_us == pytest.approx(1221.4, rel=1e-4)
    assert model.without(0).parameters() == start


def test_a_leak_that_a_camera_file_does_not_have_can_be_found() -> None:
    dry = Parameters.of("paper").changed({"junction_leak": {"k4_per_us": 0}})
    low, high = (Hypothesis(dry).parameters([0, 0, 0, log, 0, 0]).junction_leak.k4_per_us for log in (0, 2))
    assert 0 < low < 1e-9  # an event of a pixel in more than a quarter of an hour
    assert high == pytest.approx(low * np.exp(2))


@pytest.mark.parametrize("log", [-30.0, 20.0])
@pytest.mark.parametrize("candidate", catalogue(CLUES), ids=lambda one: one.effect)
def test_a_fit_far_off_meets_the_limits_and_not_an_error(candidate: Candidate, log: float) -> None:
    """Of a real recording, with a published camera file, k2 went beyond 10 000 DN."""
    model = Hypothesis(Parameters.of("paper")).with_effect(candidate, candidate.sizes[0])
    parameters = model.parameters([log] * len(model.shift))
    assert parameters == Parameters.model_validate(parameters.model_dump())
    assert (parameters.contrast_response.k2_dn == 10_000) == (log > 0)


def test_a_search_begins_at_the_smallest_values_of_its_settings() -> None:
    dry = Parameters.of("paper").changed({"junction_leak": {"k4_per_us": 0}})
    settings = SearchSettings(prior=Priors(smallest_base={"k4_per_us": 3e-9}))
    assert start_of(dry, settings).parameters().junction_leak.k4_per_us == 3e-9
