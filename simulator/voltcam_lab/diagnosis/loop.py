"""The loop: find the gap, name what is missing, add it, prove it on held-out data, look again."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .catalogue import Candidate
from .model import BASE, Model, flat
from .precise import precise
from .refit import refitted
from .rig import Rig, Values
from .robust import gap, loss
from .search import ALPHA, AS_GOOD, DOUBT, LEFT_BEHIND, Step, base_fitted, step_of
from .trial import FITTING, Trial
from .unlisted import Residual, residual_of, residual_step

Verdict = Literal["effects", "none", "unknown"]
Report = Callable[[str], None]

TOLERANCE = 0.25  # of the gap over its floor: what an explanation may leave
OPEN = 0.25  # of the gap over its floor: what frames may leave open without anything missing
SHARE = 0.8  # of the gap over its floor: an effect that removes so much is named though not all is explained
LEAST_SHARE = 0.3  # the same, of an effect that removes SHARE of it where it changes anything
CLOSING_SHARE = 0.6  # the same, of an effect that leaves next to nothing; little is soon closed by half
PLAIN = 1.0  # gap over its floor, about four floors: an effect of another form leaves less
PLAIN_SHARE = 0.9  # instead of SHARE where more than PLAIN is left: what has no name may look like an effect
OF_ALL, OF_REST = 0.9, 0.5  # the same, of several together, and of the last of these
MOVED = 2.0  # of the spread: what an effect changes
HELD_OUT_SHARE = 0.3  # of the training gain, by statistic, that held-out data must confirm
DEEPEST = 4  # effects


@dataclass(frozen=True, eq=False)
class Found:
    """An effect that was missing, the step that found it, and those that explain as much."""

    trial: Trial
    step: Step
    rivals: tuple[str, ...]

    @property
    def effect(self) -> str:
        """Its name in the registry."""
        return self.trial.candidate.effect


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What is missing, the model with it, and the steps of the search; the last one found nothing to add.

    covariance: (k, k) of the shift of the last step's model, whose effects are found; None where none are.
    residual: a term of unknown mechanism, in the model, for part of a gap that no listed effect explains.
    """

    verdict: Verdict
    found: tuple[Found, ...]
    model: Model
    steps: tuple[Step, ...]
    covariance: NDArray[np.float64] | None = None
    residual: Residual | None = None

    def after(self, one: Found) -> Step:
        """Where the search stood with this effect in the model; others may have come and gone since."""
        following = self.found[self.found.index(one) + 1 :]
        return following[0].step if following else self.steps[-1]


def diagnose(
    rig: Rig, data: Values, model: Model, candidates: Sequence[Candidate], report: Report
) -> Diagnosis:
    """Search what the model lacks to explain `data` (what the battery saw, as `Rig.observe` gives it)."""
    report("Fitting the base parameters of the camera.")
    step = step_of(rig, base_fitted(rig, model, data), data, candidates)
    report(_sentence(step))
    steps: list[Step] = [step]
    found: list[Found] = []
    while len(found) < DEEPEST and (trials := _promising(step)):
        chain = _explained(rig, data, candidates, [*steps], trials[0], report)
        if chain is None:
            break
        for one, after in chain:
            found.append(one)
            steps.append(after)
        step = steps[-1]
    if len(found) > 1:
        _drop_needless(rig, data, candidates, found, steps, report)
        step = steps[-1]
    kept, model, covariance = _needed(found, step.model), step.model, None
    verdict: Verdict = "effects" if kept else "unknown" if _excess(step) > OPEN else "none"
    if kept:
        sure = precise(rig, step.model, step.screen.spread, data)
        model, covariance = sure.model, sure.covariance
    residual = _residual(rig, data, step, report) if _excess(step) > OPEN else None
    if residual is not None:
        model = residual.model
    return Diagnosis(verdict, tuple(kept), model, tuple(steps), covariance, residual)


def _drop_needless(
    rig: Rig,
    data: Values,
    candidates: Sequence[Candidate],
    found: list[Found],
    steps: list[Step],
    report: Report,
) -> None:
    """Take out effects without which the others explain the gap as well; one found first, for want of what
    was found later, may be such. Each time there is one step more."""
    for one in [*found]:
        step, index = steps[-1], found.index(one)
        report(f"Is {one.effect} needed, now that there is more?")
        v = step.screen.spread.v
        model, mean = refitted(rig, step.model.without(index), data, v, FITTING, rounds=2)
        z = flat((data - mean) / v)
        if len(found) > 1 and z.size * (gap(z) - step.training) < step.least:
            found.remove(one)
            steps.append(step_of(rig, model, data, _left(candidates, model), steps[0]))
            report(_sentence(steps[-1]))


def _residual(rig: Rig, data: Values, step: Step, report: Report) -> Residual | None:
    report("No listed effect explains what is left: looking for a drift or a noise that does.")
    open_step = residual_step(rig, step.model, data)
    proven = _promising(open_step)
    if not proven:
        return None
    residual = residual_of(open_step, proven[0])
    report(f"It is best said as {residual.formula}.")
    return residual


def _explained(
    rig: Rig,
    data: Values,
    candidates: Sequence[Candidate],
    steps: Sequence[Step],
    trial: Trial,
    report: Report,
    depth: int = 2,
    begin: Step | None = None,
) -> list[tuple[Found, Step]] | None:
    """The effects, each with the step after it, that explain the gap of the last of `steps` beginning with
    `trial`; None where they leave too much of it. begin: the step before others that have not explained it
    alone."""
    report(f"Trying {trial.candidate.effect}.")
    step = steps[-1]
    after = step_of(rig, trial.model, data, _left(candidates, trial.model), steps[0])
    report(_sentence(after))
    one = Found(trial, step, _rivals(step, trial))
    if _explains(step, after, steps[0]) or (begin and _explain_together(begin, step, after)):
        return [(one, after)]
    following = _promising(after)
    if depth == 0 or not following:
        return None
    rest = _explained(rig, data, candidates, [*steps, after], following[0], report, depth - 1, begin or step)
    return None if rest is None else [(one, after), *rest]


def _explains(before: Step, after: Step, first: Step) -> bool:
    """Whether what was added closes the gap, or so much of it that it is there whatever else is: nearly all;
    or a part that leaves little, and nearly nothing in the statistics that it moves, of which some hold a
    wrong effect back. Effects found since the first step may have left something, too."""
    closed = TOLERANCE + LEFT_BEHIND * (_excess(first) - _excess(before))
    removed = 1 - _excess(after) / max(_excess(before), 1e-9)
    moved = np.abs(after.screen.spread.mean - before.screen.spread.mean) / before.screen.spread.v
    own = flat(moved) > MOVED
    was, left = (float((loss(flat(step.rest)) - flat(step.chance))[own].sum()) for step in (before, after))
    part = removed >= LEAST_SHARE and _excess(after) <= 2 * TOLERANCE
    alone = part and was > 0 and left <= (1 - SHARE) * was
    least = CLOSING_SHARE if before is first else LEAST_SHARE
    nearly_all = SHARE if _excess(after) <= PLAIN else PLAIN_SHARE
    return (_excess(after) <= closed and removed >= least) or removed >= nearly_all or alone


def _explain_together(begin: Step, before: Step, after: Step) -> bool:
    """Whether effects none of which explains it alone close nearly all of a gap, the last a good part of
    what the others leave, and leave nothing that is plain to see: two can take most of any other's place."""
    of_all, of_rest = (1 - _excess(after) / max(_excess(step), 1e-9) for step in (begin, before))
    plain = _excess(after) > max(PLAIN, LEFT_BEHIND * _excess(begin))
    return of_all >= OF_ALL and of_rest >= OF_REST and not plain


def _promising(step: Step) -> list[Trial]:
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


def _rivals(step: Step, best: Trial) -> tuple[str, ...]:
    """Those that explain as much, as far as chance lets one tell, or that held-out data prefer.

    Of two models at a distance d (in spreads), the true one has the lesser loss by d^2/2, give or take d.
    """
    n, close = 3 * step.screen.spread.mean.shape[1], []
    for trial in _promising(step):
        distance = float(np.linalg.norm(flat((trial.mean - best.mean) / step.screen.spread.lenient)))
        as_good = n * (best.gained - trial.gained) < AS_GOOD + DOUBT * distance
        if as_good or trial.confirmed > best.confirmed:
            close.append(trial.candidate.effect)
    return tuple(dict.fromkeys(effect for effect in close if effect != best.candidate.effect))


def _left(candidates: Sequence[Candidate], model: Model) -> list[Candidate]:
    """Those that are not in the model."""
    there = {(candidate.effect, candidate.names) for candidate, _ in model.accepted}
    return [candidate for candidate in candidates if (candidate.effect, candidate.names) not in there]


def _needed(found: list[Found], model: Model) -> list[Found]:
    """Effects whose fitted size is not next to nothing."""
    kept, place = [], len(BASE)
    for one, (_, size) in zip(found, model.accepted, strict=True):
        if np.exp(model.shift[place]) > 0.05:
            kept.append(one)
        place += len(size)
    return kept


def _excess(step: Step) -> float:
    """The training gap over what chance leaves."""
    return step.training - step.floor_training


def _sentence(step: Step) -> str:
    gap = (
        f"Gap {step.training:.2f} in training and {step.held_out:.2f} in held-out data, where chance leaves"
        f" {step.floor_training:.2f}"
    )
    if not step.trials:
        return f"{gap}; no effect explains more of it than chance lets one."
    return f"{gap}; {step.trials[0].candidate.effect} explains most of it."
