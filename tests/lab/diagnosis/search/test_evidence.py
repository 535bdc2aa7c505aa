"""The evidence for effects, by what is left of gaps, and by signatures of which it is known who stands in."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import beta

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.search.evidence import of_what_follows, stand_ins, weighed
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.screen import LIGHT, Screen, Signature
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import TwinSpread
from voltcam_lab.statistics import PARTS

from ..made_rig import DEAD, DEAD_TIME, MISMATCH, START

NAMING = DEFAULTS.naming
USUAL = np.random.default_rng(3).beta(4, 2.5, 20).tolist()  # two thirds of the gap, most of them
N = 100


def enough(excess: float, left: float, largest: float | None = None) -> bool:
    return weighed(excess, left, largest or excess, USUAL, NAMING).enough(NAMING)


@pytest.mark.parametrize(
    ("excess", "left", "named"),
    [
        (4.0, 0.2, True),  # what light leaves
        (4.0, 1.2, False),  # a third: stand-ins do that
        (32.0, 0.6, True),  # light, and what the form of a strong effect leaves
        (32.0, 9.0, False),  # seldom for a stand-in, but far more than light and form leave
        (0.5, 0.05, True),
        (0.5, 0.4, False),
        (0.5, 0.6, False),  # it makes things worse
    ],
)
def test_effects_are_named_for_what_only_those_that_are_there_leave(
    excess: float, left: float, named: bool
) -> None:
    assert enough(excess, left) == named


def test_after_a_strong_effect_more_may_be_left() -> None:
    assert not enough(3.0, 0.9)
    assert weighed(3.0, 0.9, 40.0, USUAL, NAMING).log_odds > weighed(3.0, 0.9, 3.0, USUAL, NAMING).log_odds


def test_the_less_is_left_the_more_is_it_for_the_effects() -> None:
    found = [weighed(2.0, left, 2.0, USUAL, NAMING) for left in (0.0, 0.1, 0.3, 1.0)]
    assert np.all(np.diff([one.log_odds for one in found]) < 0)
    assert np.all(np.diff([one.wrong for one in found]) > 0)


def test_what_has_no_name_is_given_one_as_seldom_as_was_asked() -> None:
    """Of 4000 stand-ins of the same law, at most one in twenty; more than three sd above that do not pass."""
    left = np.random.default_rng(4).beta(4, 2.5, 4000)
    named = np.mean([enough(2.0, 2.0 * share) for share in left])
    assert named <= NAMING.wrong + 3 * np.sqrt(NAMING.wrong / 4000)


@pytest.mark.parametrize("p_value", [1e-40, 1e-4, 0.02, 0.3])
def test_what_the_score_test_still_finds_lowers_the_odds_by_the_likeliest_law_of_it(p_value: float) -> None:
    """Against p = 1 the density of xi p^(xi - 1), where it is largest."""
    xi = np.geomspace(1e-4, 1, 100_000)
    likeliest = float((np.log(xi) + (xi - 1) * np.log(p_value)).max())
    assert of_what_follows(p_value) == pytest.approx(-likeliest, abs=1e-5)


def test_what_the_score_test_does_not_find_leaves_the_odds() -> None:
    assert of_what_follows(0.37) == of_what_follows(1.0) == 0
    assert -700 < of_what_follows(0.0) < of_what_follows(1e-20) < -40


def test_the_law_of_stand_ins_is_that_of_those_seen_where_there_are_many() -> None:
    """Of a gap so large that light leaves next to nothing of it."""
    seen, large = np.random.default_rng(5).beta(3, 5, 3000).tolist(), 1000.0
    naming = replace(NAMING, form=0.0)
    for share in (0.1, 0.3, 0.6):
        found = weighed(large, large * share, large, seen, naming).wrong
        assert found == pytest.approx(beta(3, 5).cdf(share), abs=0.03)


@pytest.mark.parametrize("excess", [0.3, 0.6, 2.0])
def test_light_leaves_as_much_where_an_effect_stands_in(excess: float) -> None:
    """By 100 000 draws of what both leave together: shares are within six sd."""
    rng, seen = np.random.default_rng(6), np.random.default_rng(7).beta(4, 3, 3000)
    mean = NAMING.light + NAMING.form * excess
    light = rng.exponential(mean, 200_000)
    light = light[light < excess][:100_000]
    left = light + rng.choice(seen, light.size) * (excess - light)
    for share in (0.2, 0.5, 0.8):
        found = weighed(excess, excess * share, excess, seen.tolist(), NAMING).wrong
        assert found == pytest.approx(np.mean(left <= excess * share), abs=0.02)


def test_the_odds_are_those_of_two_laws_of_what_is_left() -> None:
    """In a narrow bin about what is left, draws of each law are as frequent as the odds say."""
    rng, seen = np.random.default_rng(8), np.random.default_rng(9).beta(4, 3, 300_000)
    excess, left, n = 0.6, 0.15, 1_000_000
    mean = NAMING.light + NAMING.form * excess
    light = rng.exponential(mean, 2 * n)
    light = light[light < excess][:n]
    stands_in = light + rng.choice(seen, n) * (excess - light)
    near = [np.count_nonzero(abs(what - left) < 0.01) for what in (light, stands_in)]
    found = weighed(excess, left, excess, seen.tolist(), NAMING).log_odds
    assert found == pytest.approx(np.log(near[0] / near[1]), abs=0.1)


def made_screen(*columns: tuple[Candidate, np.ndarray]) -> Screen:
    """Signatures by hand, (N,) in each part; nothing can be taken up by own parameters."""
    zero, one = np.zeros((PARTS, N)), np.ones((PARTS, N))
    hypothesis = Hypothesis(START)
    slopes = np.zeros((PARTS, N, len(hypothesis.shift)))
    spread = TwinSpread(zero, one, zero, one, [], slopes, 4, zero)
    signatures = tuple(
        Signature(candidate, candidate.sizes[0], np.tile(column, (PARTS, 1))) for candidate, column in columns
    )
    base = np.zeros((PARTS, N, len(hypothesis.shift) + LIGHT))
    return Screen(hypothesis, spread, base, signatures, DEFAULTS, np.ones(N, np.bool_))


def test_a_stand_in_leaves_what_is_not_along_its_own_signature() -> None:
    """Small deviations, whose loss is their square: two at an angle leave its sine squared of each other."""
    first, second, third = np.eye(N)[:3] * 10
    turned = 0.8 * first + 0.6 * second
    screen = made_screen((DEAD_TIME, first), (MISMATCH, turned), (DEAD, third))
    left = stand_ins(screen, 0.001, 1)
    assert left == pytest.approx([0.36, 0.36, 1.0], abs=0.02)


def test_two_stand_ins_leave_less_than_one() -> None:
    first, second, third = np.eye(N)[:3] * 10
    screen = made_screen((DEAD_TIME, first), (MISMATCH, second), (DEAD, 0.6 * (first + second) + 0.5 * third))
    one, two = (stand_ins(screen, 0.001, effects)[2] for effects in (1, 2))
    assert one == pytest.approx(1 - 0.36 / 0.97, abs=0.02)
    assert two == pytest.approx(0.25 / 0.97, abs=0.02)


def test_an_effect_stands_in_only_with_the_sign_that_it_has() -> None:
    first = np.eye(N)[0] * 10
    screen = made_screen((DEAD_TIME, first), (MISMATCH, -first))
    assert stand_ins(screen, 0.001, 1) == pytest.approx([1.0, 1.0], abs=1e-6)
