"""The evidence for effects, by what is left of gaps and by what the score test finds in it."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import kstest

from voltcam_lab.diagnosis.search.evidence import Evidence, Laws
from voltcam_lab.diagnosis.search.settings import DEFAULTS

NAMING = DEFAULTS.naming
SEEN = 0.02
Drawn = NDArray[np.float64]


def laws(excess: float, largest: float | None = None, effects: int = 1) -> Laws:
    light = NAMING.light + NAMING.form * (largest or excess)
    return Laws(excess, light, SEEN, effects, NAMING)


def weighed(
    excess: float, left: float, p_value: float = 0.5, largest: float | None = None, effects: int = 1
) -> Evidence:
    return laws(excess, largest, effects).evidence(left, p_value)


@pytest.mark.parametrize(
    ("excess", "left", "p_value", "named"),
    [
        (4.0, 0.1, 0.5, True),  # what light leaves
        (4.0, 1.2, 0.5, False),  # a third: stand-ins do that
        (32.0, 0.6, 0.5, True),  # light, and what the form of a strong effect leaves
        (32.0, 9.0, 0.5, False),  # far more than light and form leave
        (0.5, 0.05, 0.5, True),
        (0.5, 0.4, 0.5, False),
        (0.5, 0.6, 0.5, False),  # it makes things worse
        (4.0, 0.4, 1e-5, False),  # a tenth, and much to be found in it
        (32.0, 0.6, 1e-40, True),  # something else is missing besides: stand-ins leave so little seldom
        (32.0, 3.2, 1e-40, False),  # they do leave a tenth
    ],
)
def test_effects_are_named_for_what_only_those_that_are_there_leave(
    excess: float, left: float, p_value: float, named: bool
) -> None:
    assert weighed(excess, left, p_value).enough(NAMING) == named


def test_after_a_strong_effect_more_may_be_left() -> None:
    assert not weighed(3.0, 0.9, largest=3.0).enough(NAMING)
    assert weighed(3.0, 0.9, largest=40.0).log_odds > weighed(3.0, 0.9, largest=3.0).log_odds


def test_the_less_is_left_the_more_is_it_for_the_effects() -> None:
    found = [weighed(2.0, left) for left in (0.0, 0.1, 0.3, 1.0)]
    assert np.all(np.diff([one.log_odds for one in found]) < 0)
    assert np.all(np.diff([one.wrong for one in found]) > 0)


def test_the_less_is_found_in_what_is_left_the_more_is_it_for_the_effects() -> None:
    found = [weighed(4.0, 0.3, p_value) for p_value in (0.9, 0.1, 1e-3, 1e-6)]
    assert np.all(np.diff([one.log_odds for one in found]) < 0)
    assert np.all(np.diff([one.wrong for one in found]) > 0)


def test_effects_that_are_there_stay_likelier_whatever_is_found_besides() -> None:
    """However small the p-value: one claim lets it be so."""
    assert weighed(32.0, 0.3, 1e-20).enough(NAMING)
    assert weighed(32.0, 0.3, 0.0).enough(NAMING)


def found_by_score(missing: Drawn, rng: np.random.Generator) -> Drawn:
    """P-values where so much is missing still, by their law."""
    power = NAMING.unseen + (1 - NAMING.unseen) / (1 + missing / SEEN)
    return np.asarray(rng.random(missing.size) ** (1 / power))


def stand_ins(excess: float, effects: int, n: int) -> tuple[Drawn, Drawn]:
    """What n of them leave, and the p-values in it, by the laws they are said to have."""
    rng, (mean, sd) = np.random.default_rng(14), NAMING.stand_in
    size = mean * (1 - mean) / sd**2 - 1
    share = rng.beta(mean * size, (1 - mean) * size, (n, effects)).prod(axis=1)
    light = rng.exponential(NAMING.light + NAMING.form * excess, 20 * n)
    light = light[light < excess][:n]
    missing = share * (excess - light)
    return light + missing, found_by_score(missing, rng)


@pytest.mark.parametrize("excess", [0.3, 1.0, 10.0])
def test_what_has_no_name_is_given_one_as_seldom_as_was_asked(excess: float) -> None:
    """Of 2000 stand-ins, at most one in twenty; more than three sd above that do not pass."""
    left, p_values = stand_ins(excess, 1, 2000)
    law = laws(excess)
    named = np.mean([law.evidence(*one).enough(NAMING) for one in zip(left, p_values, strict=True)])
    assert named <= NAMING.wrong + 3 * np.sqrt(NAMING.wrong / 2000)


@pytest.mark.parametrize(("excess", "effects"), [(0.3, 1), (5.0, 1), (5.0, 2)])
def test_how_often_stand_ins_have_such_odds_is_uniform_over_stand_ins(excess: float, effects: int) -> None:
    """Of 1000: Kolmogorov-Smirnov fails by chance once in 1000. Two have a law of the same moments."""
    left, p_values = stand_ins(excess, effects, 1000)
    law = laws(excess, effects=effects)
    wrong = [law.evidence(*one).wrong for one in zip(left, p_values, strict=True)]
    assert kstest(wrong, "uniform").pvalue > 1e-3


def test_the_odds_are_those_of_the_laws_of_what_is_left_and_of_p_values() -> None:
    """In a narrow bin about both, draws of each claim are as frequent as the odds say."""
    rng, excess, left, p_value, n = np.random.default_rng(8), 0.6, 0.15, 0.05, 3_000_000
    light = rng.exponential(NAMING.light + NAMING.form * excess, 2 * n)
    light = light[light < excess][:n]  # each claim lets light leave no more than there was
    besides = SEEN * (1 + excess / SEEN) ** rng.random(n) - SEEN  # ln(amount + SEEN) is uniform
    claims = (
        (light, rng.random(n)),
        (light + besides, found_by_score(besides, rng)),
        stand_ins(excess, 1, n),
    )
    alone, with_more, stand_in = (
        np.mean((abs(what - left) < 0.02) & (abs(np.log(p / p_value)) < 0.3)) for what, p in claims
    )
    odds = ((1 - NAMING.besides) * alone + NAMING.besides * with_more) / stand_in
    assert weighed(excess, left, p_value).log_odds == pytest.approx(np.log(odds), abs=0.1)


def test_several_stand_ins_leave_less_than_one() -> None:
    found = [weighed(4.0, 0.3, effects=effects) for effects in (1, 2, 3)]
    assert np.all(np.diff([one.log_odds for one in found]) < 0)
    assert np.all(np.diff([one.wrong for one in found]) > 0)
