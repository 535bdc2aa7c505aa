"""What stands: trials that held-out data confirm, effects that explain a gap, and what would do as well."""

import numpy as np

from .model import flat
from .robust import loss
from .step import ALPHA, AS_GOOD, DOUBT, LEFT_BEHIND, Step
from .trial import Trial

TOLERANCE = 0.25  # of the gap over its floor: what an explanation may leave
SHARE = 0.8  # of the gap over its floor: an effect that removes so much is named though not all is explained
LEAST_SHARE = 0.3  # the same, of an effect that removes SHARE of it where it changes anything
CLOSING_SHARE = 0.6  # the same, of an effect that leaves next to nothing; little is soon closed by half
PLAIN = 1.0  # gap over its floor, about four floors: an effect of another form leaves less
PLAIN_SHARE = 0.9  # instead of SHARE where more than PLAIN is left: what has no name may look like an effect
DISTINCT_SHARE, OTHERS_SHARE = 0.75, 0.25  # the same, where no other effect removes the second
OF_ALL, OF_REST = 0.9, 0.5  # the same, of several together, and of the last of these
MOVED = 2.0  # of the spread: what an effect changes
HELD_OUT_SHARE = 0.3  # of the training gain, by statistic, that held-out data must confirm
STRONGEST = 20.0  # times the largest size that an effect is looked for at
A_PART = 0.25  # of the gap over its floor: an effect that removes less is no part of an explanation
FEW_RUNS = 0.1  # by which the gap of a trial, seen in a few runs, may be too large
UNNAMED = 0.15  # gap over its floor: effects that leave more are held against forms without a name


def explains(before: Step, after: Step, first: Step) -> bool:
    """Whether what was added closes the gap, or so much of it that it is there whatever else is: nearly all;
    or most of it at the first step, where nothing else has anything like it: what stands in for something
    without a name is seldom alone; or a part that leaves little, and nearly nothing in the statistics that it
    moves, of which some hold a wrong effect back. Effects found since the first step may have left something,
    too."""
    closed = TOLERANCE + LEFT_BEHIND * (first.excess - before.excess)
    removed = 1 - after.excess / max(before.excess, 1e-9)
    moved = np.abs(after.screen.spread.mean - before.screen.spread.mean) / before.screen.spread.v
    own = flat(moved) > MOVED
    was, left = (float((loss(flat(step.rest)) - flat(step.chance))[own].sum()) for step in (before, after))
    part = removed >= LEAST_SHARE and after.excess <= 2 * TOLERANCE
    alone = part and was > 0 and left <= (1 - SHARE) * was
    least = CLOSING_SHARE if before is first else LEAST_SHARE
    nearly_all = SHARE if after.excess <= PLAIN else PLAIN_SHARE
    distinct = before is first and removed >= DISTINCT_SHARE and _others_remove(before, after) < OTHERS_SHARE
    return (after.excess <= closed and removed >= least) or removed >= nearly_all or alone or distinct


def _others_remove(before: Step, after: Step) -> float:
    """The largest share of the gap that any effect but the added one has removed in its trial."""
    added = after.model.accepted[-1][0].effect
    left = [trial.training for trial in before.trials if trial.candidate.effect != added]
    return (before.training - min(left, default=before.training)) / max(before.excess, 1e-9)


def explain_together(begin: Step, before: Step, after: Step) -> bool:
    """Whether effects none of which explains it alone close nearly all of a gap, the last a good part of
    what the others leave, and leave nothing that is plain to see: two can take most of any other's place."""
    of_all, of_rest = (1 - after.excess / max(step.excess, 1e-9) for step in (begin, before))
    plain = after.excess > max(PLAIN, LEFT_BEHIND * begin.excess)
    return of_all >= OF_ALL and of_rest >= OF_REST and not plain


def promising(step: Step) -> list[Trial]:
    """Trials that stand, of effects no stronger than cameras may have them: nearly all pixels dead would
    explain any camera file with too much noise."""
    return [one for one in standing(step) if one.candidate.times(one.model.sizes()[-1]) <= STRONGEST]


def worth_adding(step: Step) -> Trial | None:
    """The best promising trial, if it removes A_PART of the gap, as the first of effects that explain it
    together does: to go on from less would take most of the time, and end in "unknown" all the same.

    None, too, where it is best at a size that there is not: what is there has no name, and the next best
    would be a wrong one.
    """
    best = next(iter(promising(step)), None)
    if best is None or step.training - best.training + FEW_RUNS < A_PART * step.excess:
        return None
    return best if best.candidate.possible(best.model.sizes()[-1]) else None


def standing(step: Step) -> list[Trial]:
    """Trials that stand: beyond chance over the whole catalogue, worth it, and confirmed on held-out data.

    The gap there may be smaller, of a few hot pixels: no more than that can be confirmed.
    """
    n, gap_there = step.screen.spread.mean.shape[1], step.held_out - step.floor_held_out
    if step.p_value > ALPHA:
        return []
    stand = []
    for trial in step.trials:
        enough = 3 * n * trial.gained > step.least
        possible = min(trial.gained, max(gap_there, 0.5 * trial.gained))
        if enough and trial.confirmed > HELD_OUT_SHARE * possible:
            stand.append(trial)
    return stand


def rivals_of(step: Step, best: Trial) -> tuple[str, ...]:
    """Those that explain as much, as far as chance lets one tell, or that held-out data prefer.

    Of two models at a distance d (in spreads), the true one has the lesser loss by d^2/2, give or take d.
    """
    n, close = 3 * step.screen.spread.mean.shape[1], []
    for trial in promising(step):
        distance = float(np.linalg.norm(flat((trial.mean - best.mean) / step.screen.spread.lenient)))
        as_good = n * (best.gained - trial.gained) < AS_GOOD + DOUBT * distance
        if as_good or trial.confirmed > best.confirmed:
            close.append(trial.candidate.effect)
    return tuple(dict.fromkeys(effect for effect in close if effect != best.candidate.effect))


def nearer(step: Step, trial: Trial, added: Trial) -> bool:
    """Whether a trial at a step is nearer to the data than the last of what was added from there, by more
    than chance lets one tell; both as fitted by simulation."""
    gained = flat(trial.mean).size * (added.training - trial.training)
    distance = float(np.linalg.norm(flat((trial.mean - added.mean) / step.screen.spread.lenient)))
    return gained > AS_GOOD + DOUBT * distance
