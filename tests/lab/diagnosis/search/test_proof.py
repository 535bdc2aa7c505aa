"""Which trials may be explanations, of steps and trials whose gaps are written down."""

from dataclasses import replace

import numpy as np

from voltcam_lab.diagnosis.search.proof import (
    best_to_add,
    confirmed_trials,
    fits_better,
    plausible_trials,
    rivals_of,
)
from voltcam_lab.diagnosis.search.settings import DEFAULTS

from ..made_rig import DEAD, DEAD_TIME, MISMATCH
from ..made_steps import SIZE, step, trial

PROOF = DEFAULTS.proof


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
