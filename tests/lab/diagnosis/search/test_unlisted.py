"""Forms of the open route, as formulas and in words."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.search import unlisted
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.screen import Screen, Signature
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.settings_proof import OpenRoute
from voltcam_lab.diagnosis.search.spread import TwinSpread
from voltcam_lab.diagnosis.search.step import SearchStep
from voltcam_lab.diagnosis.search.trial import Trial
from voltcam_simulator import Parameters

ROUTE = OpenRoute()


def forms(start: Parameters, whole: bool = True) -> tuple[Candidate, ...]:
    return unlisted.forms(start, ROUTE, whole)


def test_forms_of_the_open_route_are_drifts_and_noises() -> None:
    assert {one.effect for one in forms(Parameters.of("paper"))} == {"residual_drift", "residual_noise"}


def test_drifts_are_tried_either_way_below_and_above_the_leak() -> None:
    """A small one slows the leak, a large one turns it round: neither is the other's multiple."""
    start = Parameters.of("paper")
    leak = start.junction_leak.k4_per_us + 128 * start.parasitic_photocurrent.k5_per_dn_us
    for form in forms(start):
        if form.effect == "residual_drift":
            found = [form.on(start, size).residual_drift for size in form.sizes]
            most = [one.per_us * max(1, one.across, one.down) / leak for one in found]
            ways_and_sizes = {(size > 0, abs(size) > 1) for size in most}
            assert ways_and_sizes == {(True, True), (True, False), (False, True), (False, False)}


def test_across_the_image_nothing_is_looked_for_in_strips_of_it() -> None:
    start = Parameters.of("paper")
    of_strips = forms(start, whole=False)
    assert [one.others for one in forms(start) if one not in of_strips] == [
        {"power": 0.0, "across": ROUTE.steepness}
    ]


@pytest.mark.parametrize("axis", ["across", "down"])
def test_slopes_over_the_image_have_next_to_no_drift_in_the_middle(axis: str) -> None:
    start = Parameters.of("paper")
    (slope,) = (one for one in forms(start) if axis in one.others)
    for size in slope.sizes:
        drift = slope.on(start, size).residual_drift
        assert abs(drift.per_us) < 0.2 * abs(drift.per_us * getattr(drift, axis))


NONE, ALL = np.zeros((4, 1)), np.ones(1, np.bool_)


def trial(form: Candidate, size: float) -> Trial:
    hypothesis = Hypothesis(Parameters.of("paper")).with_effect(form, (size,))
    return Trial(form, hypothesis, NONE, 1.0, 1.0, 1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("effect", "name", "others", "formula"),
    [
        ("residual_drift", "per_us", {"power": -0.5}, "drift += 2.35e-07/us ((L + 20)/148)^-0.5"),
        (
            "residual_drift",
            "per_us",
            {"power": 0.0, "down": 8.0},
            "drift += 2.35e-07/us ((L + 20)/148)^0 (1 + 8 v)",
        ),
        (
            "residual_drift",
            "per_us",
            {"power": 0.0, "across": 8.0},
            "drift += 2.35e-07/us ((L + 20)/148)^0 (1 + 8 u)",
        ),
        ("residual_noise", "variance_per_us", {"power": 1.0}, "sigma^2 += 2.35e-07/us ((L + 20)/148)^1"),
    ],
)
def test_a_term_is_said_as_a_formula(effect: str, name: str, others: dict[str, float], formula: str) -> None:
    form = Candidate(effect, (name,), ((2e-7,),), others)
    assert unlisted.formula_of(trial(form, 2.3456e-7)) == formula


def test_forms_that_do_as_well_are_named_each_once_and_the_best_one_not() -> None:
    start = Parameters.of("paper")
    best, *others = forms(start)
    same = replace(best, sizes=best.sizes[:1])
    signatures = tuple(Signature(one, one.sizes[0], NONE) for one in (best, same, *others, *others))
    tied = DEFAULTS.proof.tied
    scores = np.full(len(signatures), 100.0)
    spread = TwinSpread(NONE, NONE, NONE, NONE, [], NONE[..., None], 4, NONE)
    screen = Screen(Hypothesis(start), spread, NONE[..., None], signatures, DEFAULTS, ALL)
    step = SearchStep(Hypothesis(start), screen, NONE, NONE, 1, 1, 0, 0, scores, 0.0, 30.0, ())
    names = unlisted.tied_forms(DEFAULTS, step, trial(best, best.sizes[0][0]))
    assert len(names) == len(set(names)) == len(others)
    assert "drift growing down the image" in names
    assert "noise with brightness^-0.5" in names
    behind = np.where(np.arange(len(scores)) == 2, 100 - tied + 0.1, 100 - tied - 0.1)
    behind[0] = 100
    assert (
        len(unlisted.tied_forms(DEFAULTS, replace(step, scores=behind), trial(best, best.sizes[0][0]))) == 1
    )
