"""Which trials may be explanations: those that held-out data confirm, and their rivals."""

import numpy as np

from .settings import SearchSettings
from .spread import TRAINING
from .step import SearchStep
from .trial import Trial


def confirmed_trials(settings: SearchSettings, step: SearchStep) -> list[Trial]:
    """Trials beyond chance over the whole catalogue, worth it, and confirmed on held-out data.

    The gap there may be smaller, of a few hot pixels: no more than that can be confirmed.
    """
    assert step.plan is None, "trials are made first"
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
    gained = _training_size(step) * (added.training - trial.training)
    return gained > _tied(settings, step, trial, added)


def _tied(settings: SearchSettings, step: SearchStep, one: Trial, other: Trial) -> float:
    """Training loss by which two trials must differ to be told apart."""
    screen = step.screen
    distance = float(np.linalg.norm(screen.flat((one.mean - other.mean) / screen.spread.inflated_sd)))
    return settings.proof.tied + settings.proof.tied_per_distance * distance


def _training_size(step: SearchStep) -> int:
    """Number of statistics in the training parts that are seen."""
    return len(TRAINING) * int(np.count_nonzero(step.screen.seen))
