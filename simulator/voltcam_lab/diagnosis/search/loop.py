"""The loop: find the gap, name what is missing, add it, prove it on held-out data, look again."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..catalogue.candidate import Candidate
from ..rig.rig import Rig, Values
from .model import Model, flat
from .precise import precise
from .proof import UNNAMED, explain_together, explains, nearer, rivals_of, standing, worth_adding
from .refit import refitted
from .step import Step, base_fitted, step_of
from .trial import FITTING, Trial
from .unlisted import Residual, residual_of, residual_step

Verdict = Literal["effects", "none", "unknown"]
Report = Callable[[str], None]

OPEN = 0.25  # of the gap over its floor: what frames may leave open without anything missing
DEEPEST = 4  # effects, from which no more are looked for
NOTHING = 0.05  # of an effect, as strong as it was when it was added


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
    rig: Rig,
    data: Values,
    model: Model,
    candidates: Sequence[Candidate],
    report: Report,
    whole: bool = True,
) -> Diagnosis:
    """Search what the model lacks to explain `data` (what the battery saw, as `Rig.observe` gives it). whole:
    whether the rig has all columns of the sensor."""
    report("Fitting the base parameters of the camera.")
    step = step_of(rig, base_fitted(rig, model, data), data, candidates)
    report(_sentence(step))
    steps: list[Step] = [step]
    found: list[Found] = []
    nameless: Step | None = None
    while len(found) < DEEPEST and (trial := worth_adding(step)):
        chain = _explained(rig, data, candidates, [*steps], trial, report)
        if chain is None:
            break
        nameless = _nameless(rig, data, step, chain, report, whole)
        if nameless is not None:
            break
        for one, after in chain:
            found.append(one)
            steps.append(after)
        step = steps[-1]
    if len(found) > 1:
        _drop_needless(rig, data, candidates, found, steps, report)
        step = steps[-1]
    kept, model, covariance = _needed(found, step.model), step.model, None
    verdict: Verdict = "effects" if kept else "unknown" if step.excess > OPEN else "none"
    if kept:
        sure = precise(rig, step.model, step.screen.spread, data)
        model, covariance = sure.model, sure.covariance
    residual = _residual(rig, data, step, nameless, report, whole) if step.excess > OPEN else None
    if residual is not None:
        model = residual.model
    return Diagnosis(verdict, tuple(kept), model, tuple(steps), covariance, residual)


def _nameless(
    rig: Rig,
    data: Values,
    before: Step,
    chain: Sequence[tuple[Found, Step]],
    report: Report,
    whole: bool,
) -> Step | None:
    """The step at which a drift or noise of no name is nearer than effects that explain a gap but leave
    some of it; None where none is."""
    last, after = chain[-1]
    if after.excess <= UNNAMED:
        return None
    report("Not all is explained: would a drift or a noise that nobody has a name for explain more?")
    opened = residual_step(rig, before.model, data, whole)
    proven = standing(opened)
    return opened if proven and nearer(before, proven[0], last.trial) else None


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
        bare = step.model.without(index)
        model, _ = refitted(rig, bare, data, step.screen.spread.v, FITTING, rounds=2)
        without = step_of(rig, model, data, _left(candidates, model), steps[0])
        if len(found) > 1 and flat(data).size * (without.training - step.training) < step.least:
            found.remove(one)
            steps.append(without)
            report(_sentence(without))


def _residual(
    rig: Rig, data: Values, step: Step, opened: Step | None, report: Report, whole: bool
) -> Residual | None:
    report("No listed effect explains what is left: looking for a drift or a noise that does.")
    if opened is None or opened.model is not step.model:
        opened = residual_step(rig, step.model, data, whole)
    proven = standing(opened)
    if not proven:
        return None
    residual = residual_of(opened, proven[0])
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
    one = Found(trial, step, rivals_of(step, trial))
    if explains(step, after, steps[0]) or (begin and explain_together(begin, step, after)):
        return [(one, after)]
    following = worth_adding(after)
    if depth == 0 or following is None:
        return None
    rest = _explained(rig, data, candidates, [*steps, after], following, report, depth - 1, begin or step)
    return None if rest is None else [(one, after), *rest]


def _left(candidates: Sequence[Candidate], model: Model) -> list[Candidate]:
    """Those of which not all sizes are in the model."""
    there = {(candidate.effect, name) for candidate, _ in model.accepted for name in candidate.names}
    return [one for one in candidates if not {(one.effect, name) for name in one.names} <= there]


def _needed(found: list[Found], model: Model) -> list[Found]:
    """Effects whose fitted size is not next to nothing."""
    kept = []
    for one, (candidate, began), now in zip(found, model.accepted, model.sizes(), strict=True):
        if candidate.times(now) > NOTHING * candidate.times(began):
            kept.append(one)
    return kept


def _sentence(step: Step) -> str:
    gap = (
        f"Gap {step.training:.2f} in training and {step.held_out:.2f} in held-out data, where chance leaves"
        f" {step.floor_training:.2f}"
    )
    if not step.trials:
        return f"{gap}; no effect explains more of it than chance lets one."
    return f"{gap}; {step.trials[0].candidate.effect} explains most of it."
