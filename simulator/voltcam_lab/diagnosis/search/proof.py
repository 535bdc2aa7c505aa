"""Tests of an explanation: trials that held-out data confirm, effects that explain a gap, and rivals."""

import numpy as np

from .robust import huber
from .settings import SearchSettings
from .spread import TRAINING, flat
from .step import SearchStep
from .trial import Trial


def explains(settings: SearchSettings, before: SearchStep, after: SearchStep, first: SearchStep) -> bool:
    """Whether what was added closes the gap, or so much of it that it is there whatever else is.

    That is nearly all; or most of it at the first step, where no other effect has anything like it; or a
    part that leaves little, and nearly nothing in the statistics that it moves, of which a wrong effect makes
    some worse. Effects found since the first step may have left something, too.
    """
    proof = settings.proof
    closed = proof.closed + proof.left_behind * (first.excess - before.excess)
    removed = 1 - after.excess / max(before.excess, 1e-9)
    moved = np.abs(after.screen.spread.mean - before.screen.spread.mean) / before.screen.spread.sd
    own = flat(moved) > proof.moved
    was, left = (
        float((huber(flat(step.rest), settings.huber_z) - flat(step.chance))[own].sum())
        for step in (before, after)
    )
    part = removed >= proof.least_share and after.excess <= proof.part_closed
    alone = part and was > 0 and left <= (1 - proof.share) * was
    least = proof.closing_share if before is first else proof.least_share
    nearly_all = proof.share if after.excess <= proof.plain_excess else proof.plain_share
    distinct = (
        before is first
        and removed >= proof.distinct_share
        and _others_remove(before, after) < proof.others_share
    )
    return (after.excess <= closed and removed >= least) or removed >= nearly_all or alone or distinct


def _others_remove(before: SearchStep, after: SearchStep) -> float:
    """The largest share of the gap that any effect but the added one has removed in its trial."""
    added = after.hypothesis.accepted[-1][0].effect
    left = [trial.training for trial in before.trials if trial.candidate.effect != added]
    return (before.training - min(left, default=before.training)) / max(before.excess, 1e-9)


def explain_together(
    settings: SearchSettings, begin: SearchStep, before: SearchStep, after: SearchStep
) -> bool:
    """Whether effects none of which explains it alone close nearly all of a gap, the last a good part of
    what the others leave, and leave nothing that is plain to see: two can take most of any other's place."""
    proof = settings.proof
    of_all, of_rest = (1 - after.excess / max(step.excess, 1e-9) for step in (begin, before))
    plain = after.excess > max(proof.plain_excess, proof.left_behind * begin.excess)
    return of_all >= proof.together_share and of_rest >= proof.last_share and not plain


def confirmed_trials(settings: SearchSettings, step: SearchStep) -> list[Trial]:
    """Trials beyond chance over the whole catalogue, worth it, and confirmed on held-out data.

    The gap there may be smaller, of a few hot pixels: no more than that can be confirmed.
    """
    proof, gap_there = settings.proof, step.held_out - step.floor_held_out
    if step.p_value > settings.score_test.alpha:
        return []
    confirmed = []
    for trial in step.trials:
        enough = _training_size(step) * trial.gained > step.least
        possible = min(trial.gained, max(gap_there, proof.held_out_possible * trial.gained))
        if enough and trial.confirmed > proof.held_out_share * possible:
            confirmed.append(trial)
    return confirmed


def plausible_trials(settings: SearchSettings, step: SearchStep) -> list[Trial]:
    """Confirmed trials of effects no stronger than cameras may have them."""
    return [
        one
        for one in confirmed_trials(settings, step)
        if one.candidate.times(one.hypothesis.sizes()[-1]) <= settings.proof.strongest
    ]


def best_to_add(settings: SearchSettings, step: SearchStep) -> Trial | None:
    """The best plausible trial, if it removes enough of the gap to be the first of effects that explain it
    together.

    None, too, where it is best at an impossible size: what is there has no name, and the next best would be
    a wrong one.
    """
    proof, best = settings.proof, next(iter(plausible_trials(settings, step)), None)
    if best is None or step.training - best.training + proof.few_runs < proof.part_share * step.excess:
        return None
    return best if best.candidate.possible(best.hypothesis.sizes()[-1]) else None


def rivals_of(settings: SearchSettings, step: SearchStep, best: Trial) -> tuple[str, ...]:
    """Effects that explain as much, as far as chance lets one tell, or that held-out data prefer."""
    rivals = []
    for trial in plausible_trials(settings, step):
        less = _training_size(step) * (best.gained - trial.gained)
        if less < _tied(settings, step, trial, best) or trial.confirmed > best.confirmed:
            rivals.append(trial.candidate.effect)
    return tuple(dict.fromkeys(effect for effect in rivals if effect != best.candidate.effect))


def fits_better(settings: SearchSettings, step: SearchStep, trial: Trial, added: Trial) -> bool:
    """Whether a trial at a step leaves less of a gap than the last of what was added from there, by more
    than chance lets one tell; both as fitted by simulation."""
    gained = flat(trial.mean).size * (added.training - trial.training)
    return gained > _tied(settings, step, trial, added)


def _tied(settings: SearchSettings, step: SearchStep, one: Trial, other: Trial) -> float:
    """Training loss by which two trials must differ to be told apart."""
    distance = float(np.linalg.norm(flat((one.mean - other.mean) / step.screen.spread.inflated_sd)))
    return settings.proof.tied + settings.proof.tied_per_distance * distance


def _training_size(step: SearchStep) -> int:
    """Number of statistics in the training parts."""
    return len(TRAINING) * int(step.screen.spread.mean.shape[1])
