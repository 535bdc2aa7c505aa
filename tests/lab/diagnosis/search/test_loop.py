"""The search, on a rig whose answers are formulas."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.loop import Diagnosis, diagnose
from voltcam_lab.diagnosis.search.state import Search
from voltcam_lab.statistics import IN_ANY_LIGHT, Values
from voltcam_simulator import Parameters

from ..made_rig import CATALOGUE, DEAD, DEAD_TIME, MISMATCH, PATTERNS, START, MadeRig, response

BASE = Hypothesis(START, shift=(0.2, -0.1, 0.1, -0.2, 0.15, 0.1)).parameters()


def asked(data: Values) -> Diagnosis:
    rig = MadeRig()
    return diagnose(Search(rig, data + rig.noise(4711), CATALOGUE), Hypothesis(START))


def test_nothing_is_named_where_nothing_is_missing() -> None:
    found = asked(response(BASE))
    assert (found.verdict, found.found) == ("none", ())


@pytest.mark.parametrize(("one", "size"), [(DEAD_TIME, 2500.0), (MISMATCH, 0.15), (DEAD, 0.02)])
def test_the_effect_that_is_missing_is_named_with_its_size(one, size: float) -> None:  # type: ignore[no-untyped-def]
    found = asked(response(one.on(BASE, (size,))))
    assert found.verdict == "effects"
    assert [each.effect for each in found.found] == [one.effect]
    fitted = getattr(getattr(found.hypothesis.parameters(), one.effect), one.names[0])
    assert fitted == pytest.approx(size, rel=0.1)
    assert found.steps[-1].held_out < 0.5 * found.steps[0].held_out


def test_an_effect_that_explains_all_is_named_though_three_that_explain_a_part_score_higher() -> None:
    """Long dead times are little like the short ones of signatures, and like three others besides."""
    jitter = Candidate("latency", ("jitter_us",), ((1000.0,),))

    def bent(parameters: Parameters) -> Values:
        long_ms = max(parameters.refractory_period.period_us / 1000 - 3, 0)
        parts = long_ms * (0.7 * PATTERNS[7:10].sum(axis=0) - 1.05 * PATTERNS[6])
        return response(parameters) + parts + parameters.latency.jitter_us / 1000 * PATTERNS[9]

    rig = MadeRig(bent)
    data = bent(DEAD_TIME.on(BASE, (10_000.0,))) + rig.noise(4711)
    found = diagnose(Search(rig, data, (*CATALOGUE, jitter)), Hypothesis(START))
    scores = zip(found.steps[0].scores, found.steps[0].screen.signatures, strict=True)
    best = sorted(scores, key=lambda one: -one[0])
    assert DEAD_TIME not in [one.candidate for _, one in best[:3]]
    assert found.steps[0].trials[0].candidate is DEAD_TIME
    assert [each.effect for each in found.found] == ["refractory_period"]


@pytest.mark.parametrize(("shows_in", "verdict"), [("any light", "effects"), ("known light", "none")])
def test_an_effect_that_few_statistics_show_is_named_if_light_has_no_part_in_these(
    shows_in: str, verdict: str
) -> None:
    """Among all statistics it is little, and something that nobody knows is more."""
    few = IN_ANY_LIGHT if shows_in == "any light" else np.roll(IN_ANY_LIGHT, -IN_ANY_LIGHT.sum())

    def silent(parameters: Parameters) -> Values:
        seen = PATTERNS[8] * np.where(few, 100 * parameters.dead_pixels.fraction, 0)
        return response(DEAD.on(parameters, (0.0,))) + seen

    rig = MadeRig(silent)
    data = silent(DEAD.on(BASE, (0.02,))) + 0.5 * PATTERNS[10] * ~few + rig.noise(4711)
    found = diagnose(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert found.verdict == verdict
    assert [one.effect for one in found.found] == (["dead_pixels"] if verdict == "effects" else [])


@pytest.mark.parametrize(("fraction", "named"), [(0.02, True), (0.001, False)])
def test_a_further_effect_that_few_statistics_show_is_named_as_well(fraction: float, named: bool) -> None:
    """Of all statistics, a hundredth of what the first effect explained is asked."""

    def silent(parameters: Parameters) -> Values:
        seen = PATTERNS[8] * np.where(IN_ANY_LIGHT, 100 * parameters.dead_pixels.fraction, 0)
        return response(DEAD.on(parameters, (0.0,))) + seen

    rig = MadeRig(silent)
    data = silent(DEAD.on(DEAD_TIME.on(BASE, (6000.0,)), (fraction,))) + rig.noise(4711)
    found = diagnose(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert found.verdict == "effects"
    assert [one.effect for one in found.found] == ["refractory_period", *["dead_pixels"] * named]


def test_two_effects_are_both_named() -> None:
    found = asked(response(DEAD.on(MISMATCH.on(BASE, (0.2,)), (0.02,))))
    assert {each.effect for each in found.found} == {"threshold_mismatch", "dead_pixels"}


@pytest.mark.parametrize(("left", "verdict"), [(1.5, "effects"), (4.0, "unknown")])
def test_two_effects_none_of_which_explains_enough_are_named_if_they_do_together(
    left: float, verdict: str
) -> None:
    """Beside them there is something that nobody knows: of 23 above chance 0.8 is left, or more than 4."""
    found = asked(response(MISMATCH.on(DEAD_TIME.on(BASE, (9000.0,)), (0.5,))) + left * PATTERNS[10])
    assert found.verdict == verdict
    effects = {each.effect for each in found.found}
    assert effects == ({"refractory_period", "threshold_mismatch"} if verdict == "effects" else set())


@pytest.mark.parametrize(("sigma", "rivals"), [(0.06, ("reset_noise",)), (0.4, ())])
def test_effects_that_are_nearly_alike_are_rivals_where_there_is_little_of_them(
    sigma: float, rivals: tuple[str, ...]
) -> None:
    def alike(parameters: Parameters) -> Values:
        other = 10 * parameters.reset_noise.sigma
        return response(parameters) + other * (PATTERNS[7] + 0.25 * PATTERNS[9])

    rig = MadeRig(alike)
    data = alike(MISMATCH.on(BASE, (sigma,))) + rig.noise(4711)
    catalogue = (*CATALOGUE, Candidate("reset_noise", ("sigma",), ((0.1,),)))
    (found,) = diagnose(Search(rig, data, catalogue), Hypothesis(START)).found
    assert (found.effect, found.rivals) == ("threshold_mismatch", rivals)


@pytest.mark.parametrize(("fraction", "verdict"), [(0.1, "effects"), (0.3, "unknown")])
def test_an_effect_many_times_as_strong_as_it_is_looked_for_is_not_named(
    fraction: float, verdict: str
) -> None:
    assert asked(response(DEAD.on(BASE, (fraction,)))).verdict == verdict


def test_an_effect_stronger_than_the_registry_lets_it_be_is_not_named_nor_the_next_best() -> None:
    found = asked(response(MISMATCH.on(BASE, (0.5,))) + 3 * PATTERNS[7])
    assert (found.verdict, found.found) == ("unknown", ())
    assert found.steps[0].trials[0].candidate is MISMATCH


def test_a_pattern_that_is_not_in_the_catalogue_is_called_unknown() -> None:
    found = asked(response(BASE) + 3 * PATTERNS[10])
    assert (found.verdict, found.found) == ("unknown", ())


@pytest.mark.parametrize(("beside", "tried"), [(4.0, True), (12.0, False)])
def test_an_effect_that_removes_little_of_a_large_gap_is_not_added(beside: float, tried: bool) -> None:
    """A dead time beside something that nobody knows, of which it is a half or a tenth."""
    said: list[str] = []
    rig = MadeRig()
    data = response(DEAD_TIME.on(BASE, (5000.0,))) + beside * PATTERNS[10] + rig.noise(4711)
    found = diagnose(Search(rig, data, CATALOGUE, say=said.append), Hypothesis(START))
    assert found.verdict == "unknown"
    assert found.steps[0].trials[0].candidate is DEAD_TIME
    assert ("Trying refractory_period." in said) == tried


@pytest.mark.parametrize(("beside", "verdict"), [(0.3, "effects"), (0.9, "unknown")])
def test_an_effect_that_closes_a_small_gap_by_less_than_half_is_not_named(
    beside: float, verdict: str
) -> None:
    """What nobody knows leaves a quarter of the gap, or three fifths of it, and either is little."""
    found = asked(response(DEAD_TIME.on(BASE, (600.0,))) + beside * PATTERNS[10])
    assert found.verdict == verdict
    assert (len(found.found) == 1) == (verdict == "effects")


@pytest.mark.parametrize(("beside", "verdict"), [(2.0, "effects"), (6.0, "unknown")])
def test_an_effect_that_leaves_a_plain_gap_is_named_if_stand_ins_leave_far_more(
    beside: float, verdict: str
) -> None:
    """Less than a twentieth of the gap is left, or a quarter: either is plain to see."""
    found = asked(response(DEAD_TIME.on(BASE, (9000.0,))) + beside * PATTERNS[10])
    assert found.verdict == verdict
    assert [one.effect for one in found.found] == (["refractory_period"] if verdict == "effects" else [])


@pytest.mark.parametrize(("of_the_rest", "verdict"), [(0, "effects"), (1, "unknown")])
def test_an_effect_is_not_named_where_a_drift_without_a_name_explains_the_rest_too(
    of_the_rest: float, verdict: str
) -> None:
    """A dead time leaves a fifteenth of the gap; a drift leaves as much, or nothing of it."""
    leak = START.junction_leak.k4_per_us + 128 * START.parasitic_photocurrent.k5_per_dn_us

    def drifting(parameters: Parameters) -> Values:
        amount = parameters.residual_drift.per_us / leak
        return response(parameters) + amount * (9 * PATTERNS[6] + of_the_rest * 2 * PATTERNS[10])

    rig = MadeRig(drifting)
    data = response(BASE) + 9 * PATTERNS[6] + 2 * PATTERNS[10] + rig.noise(4711)
    found = diagnose(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert found.verdict == verdict
    assert [each.effect for each in found.found] == ([] if of_the_rest else ["refractory_period"])
    assert not of_the_rest or (found.residual and found.residual.formula.startswith("drift"))


def test_what_held_out_data_do_not_confirm_is_not_named() -> None:
    data = response(BASE)
    data[:3] += 2.5 * PATTERNS[6][:3]  # a dead time, in the training parts only
    found = asked(data)
    assert "refractory_period" not in [each.effect for each in found.found]


def test_an_effect_of_which_the_held_out_pixels_have_less_is_named() -> None:
    """Few pixels are hot, and it is by chance in which part of the array these are."""

    def half_there(parameters: Parameters) -> Values:
        seen = response(parameters)
        seen[3] -= 0.5 * (100 * parameters.dead_pixels.fraction) * PATTERNS[8][3]
        return seen

    rig = MadeRig(half_there)
    data = half_there(DEAD.on(BASE, (0.02,))) + rig.noise(4711)
    found = diagnose(Search(rig, data, CATALOGUE), Hypothesis(START))
    assert [each.effect for each in found.found] == ["dead_pixels"]


def test_the_same_data_give_the_same_verdict() -> None:
    data = response(DEAD_TIME.on(BASE, (900.0,)))
    first, again = asked(data), asked(data)
    assert first.hypothesis.shift == again.hypothesis.shift
    np.testing.assert_array_equal(first.steps[0].scores, again.steps[0].scores)
