"""What counts as an explanation, of steps and trials whose gaps are written down."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.proof import (
    best_to_add,
    confirmed_trials,
    explain_together,
    explains,
    fits_better,
    plausible_trials,
    rivals_of,
)
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.statistics import PARTS

from ..made_rig import DEAD, DEAD_TIME, MISMATCH
from ..made_steps import SIZE, N, step, trial

PROOF = DEFAULTS.proof
RIVAL = trial(MISMATCH, 2.0)  # removes half of a gap of 4


@pytest.mark.parametrize(
    ("gap", "left", "named"),
    [
        (4.0, 0.2, True),  # closed
        (4.0, 0.7, True),  # nine tenths of it, nearly all
        (4.0, 0.9, False),  # three quarters, where another removes half
        (0.5, 0.21, False),  # closed, but a small gap is soon closed by half
        (0.5, 0.19, True),
        (12.0, 1.15, True),  # nine tenths of a gap after which much is plain to see
        (12.0, 1.3, False),
    ],
)
def test_a_first_effect_must_close_the_gap_or_nearly(gap: float, left: float, named: bool) -> None:
    before, after = step(gap, RIVAL), step(left, added=DEAD_TIME)
    assert explains(DEFAULTS, before, after, before) == named


def test_of_most_of_a_gap_it_is_enough_where_no_other_has_anything_like_it() -> None:
    after = step(0.95, added=DEAD_TIME)
    with_rival, alone = step(4.0, RIVAL), step(4.0, trial(MISMATCH, 3.5), trial(DEAD_TIME, 1.0))
    assert not explains(DEFAULTS, with_rival, after, with_rival)
    assert explains(DEFAULTS, alone, after, alone)
    assert not explains(DEFAULTS, alone, after, step(9.0))  # only at the first step


def test_a_further_effect_needs_less_where_it_closes_the_gap_and_may_leave_what_others_left() -> None:
    """4 % of what was explained before may be left besides."""
    first, before = step(8.0), step(0.7, RIVAL)
    allowed = PROOF.closed + PROOF.left_behind * 7.3
    assert explains(DEFAULTS, before, step(min(allowed, 0.7 * 0.69), added=DEAD_TIME), first)
    assert not explains(DEFAULTS, before, step(0.7 * 0.72, added=DEAD_TIME), first)
    assert not explains(DEFAULTS, step(2.0, RIVAL), step(allowed + 0.05, added=DEAD_TIME), first)


def test_a_part_of_a_gap_is_enough_where_all_that_the_effect_moves_is_explained() -> None:
    """It moves a tenth of the statistics; in these nearly nothing is left, or half."""
    before, moving = step(0.7, RIVAL), np.zeros((PARTS, N))
    moving[:, : N // 10] = 3.0
    for rest, named in ((0.1, True), (1.5, False)):
        after = step(0.4, added=DEAD_TIME)
        left = np.where(moving > 0, rest, 2.0)
        spread = replace(after.screen.spread, mean=moving)
        after = replace(after, rest=left, screen=replace(after.screen, spread=spread))
        assert explains(DEFAULTS, before, after, before) == named


@pytest.mark.parametrize(
    ("between", "left", "together"),
    [(2.0, 0.35, True), (2.0, 0.45, False), (0.6, 0.35, False)],
    ids=["all of it", "too little of all", "the last too little of the rest"],
)
def test_effects_explain_together_what_none_does_alone(between: float, left: float, together: bool) -> None:
    assert explain_together(DEFAULTS, step(4.0), step(between), step(left)) == together


def test_nothing_is_confirmed_within_chance() -> None:
    found = step(4.0, trial(DEAD_TIME, 0.0))
    assert confirmed_trials(DEFAULTS, found) == list(found.trials)
    assert confirmed_trials(DEFAULTS, replace(found, p_value=2 * DEFAULTS.score_test.alpha)) == []


def test_what_is_not_worth_it_or_not_there_in_held_out_data_is_not_confirmed() -> None:
    """A gain of 30 over 300 statistics; of what is gained held-out data must have three tenths."""
    gains = [trial(DEAD_TIME, 4 - 30.0 / SIZE - d) for d in (-0.001, 0.001)]
    assert confirmed_trials(DEFAULTS, step(4.0, *gains)) == gains[1:]
    held = [trial(DEAD_TIME, 2.0, confirmed=2.0 * PROOF.held_out_share + d) for d in (-0.01, 0.01)]
    assert confirmed_trials(DEFAULTS, step(4.0, *held)) == held[1:]
    fewer = step(4.0, held[0], held_out=1.0)  # held-out data have not so much of a gap to confirm
    assert confirmed_trials(DEFAULTS, fewer) == [held[0]]


def test_impossibly_strong_effects_are_not_named() -> None:
    weak, strong = trial(MISMATCH, 0.0), trial(MISMATCH, 0.1)
    largest = MISMATCH.times(MISMATCH.sizes[0])
    log = float(np.log(1.1 * PROOF.strongest / largest))
    shift = (*strong.hypothesis.shift[:-1], log)
    strong = replace(strong, hypothesis=replace(strong.hypothesis, shift=shift))
    assert plausible_trials(DEFAULTS, step(4.0, weak, strong)) == [weak]


def test_an_effect_that_removes_little_is_no_beginning() -> None:
    """A quarter of the excess, less what few runs may be too large by."""
    least = PROOF.part_share * 4.0 - PROOF.few_runs
    for removed, taken in ((least + 0.01, True), (least - 0.01, False)):
        one = trial(DEAD_TIME, 4.0 - removed)
        assert best_to_add(DEFAULTS, step(4.0, one)) is (one if taken else None)
    assert best_to_add(DEFAULTS, step(4.0)) is None


def test_rivals_are_those_that_chance_does_not_tell_from_the_best_or_held_out_data_prefer() -> None:
    """Each tie is 15 of summed loss, and two for each z of distance between what they do."""
    best = trial(DEAD_TIME, 0.0, confirmed=3.0)
    near, far = PROOF.tied / SIZE - 0.005, PROOF.tied / SIZE + 0.005
    tied, beaten = trial(MISMATCH, near, 2.9), trial(MISMATCH, far, 2.9)
    preferred = trial(DEAD, 1.0, confirmed=3.1)
    assert rivals_of(DEFAULTS, step(4.0, best, tied), best) == ("threshold_mismatch",)
    assert rivals_of(DEFAULTS, step(4.0, best, beaten), best) == ()
    assert rivals_of(DEFAULTS, step(4.0, best, beaten, preferred), best) == ("dead_pixels",)
    apart = trial(MISMATCH, far, 2.9, shift=1.0)  # sqrt(300) z from the best one
    assert rivals_of(DEFAULTS, step(4.0, best, apart), best) == ("threshold_mismatch",)
    other_size = trial(DEAD_TIME, near)
    assert rivals_of(DEFAULTS, step(4.0, best, other_size), best) == ()


def test_another_fits_better_by_more_than_chance_tells() -> None:
    added = trial(DEAD_TIME, 0.5)
    for less, better in ((PROOF.tied / SIZE + 0.005, True), (PROOF.tied / SIZE - 0.005, False)):
        assert fits_better(DEFAULTS, step(4.0), trial(MISMATCH, 0.5 - less), added) == better
