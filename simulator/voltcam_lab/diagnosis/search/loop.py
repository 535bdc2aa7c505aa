"""The loop: find the gap, name what is missing, add it, prove it on held-out data, look again."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..catalogue.candidate import Candidate
from ..rig.whole import Remains
from .any_light import in_any_light, tried_in_any_light
from .evidence import Evidence, evidence
from .fit import fitted_by_simulation
from .hypothesis import Hypothesis
from .left import more_than_light
from .precise import precise
from .proof import (
    best_to_add,
    confirmed_trials,
    fits_better,
    rivals_of,
)
from .spread import flat
from .state import Search
from .step import SearchStep, base_fitted, step_of, with_trials
from .trial import Trial
from .unlisted import ResidualTerm, residual_of, residual_step

Verdict = Literal["effects", "none", "unknown"]


@dataclass(frozen=True, eq=False)
class Found:
    """An effect that was missing, the step that found it, those that explain as much, and the evidence for
    it, or for it and those that were needed beside it."""

    trial: Trial
    step: SearchStep
    rivals: tuple[str, ...]
    evidence: Evidence

    @property
    def effect(self) -> str:
        """Its name in the registry."""
        return self.trial.candidate.effect


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What is missing, the hypothesis with it, and the steps of the search; the last one found nothing to
    add.

    covariance: (k, k) of the shift of the last step's hypothesis, whose effects are found; None where none
    are. residual: a term of unknown mechanism, in the hypothesis, for part of a gap that no listed effect
    explains. remains: by what the recording can still be told from the hypothesis, on the whole sensor; None
    where that was not looked at, or too few events can tell.
    """

    verdict: Verdict
    found: tuple[Found, ...]
    hypothesis: Hypothesis
    steps: tuple[SearchStep, ...]
    covariance: NDArray[np.float64] | None = None
    residual: ResidualTerm | None = None
    remains: Remains | None = None

    def after(self, one: Found) -> SearchStep:
        """The step with this effect in the hypothesis; others may have come and gone since."""
        following = self.found[self.found.index(one) + 1 :]
        return following[0].step if following else self.steps[-1]


def diagnose(search: Search, hypothesis: Hypothesis) -> Diagnosis:
    """Search what the hypothesis, a camera file, lacks to explain the measured statistics."""
    settings = search.settings
    search.say("Fitting the base parameters of the camera.")
    step = step_of(search, base_fitted(search, hypothesis))
    search.say(_sentence(step))
    steps: list[SearchStep] = [step]
    found: list[Found] = []
    open_step: SearchStep | None = None
    while len(found) < settings.most_effects:
        if found and not more_than_light(step, steps[0], None, settings):
            break
        step = steps[-1] = _tried(search, step)
        trial = best_to_add(settings, step)
        if trial is None:
            break
        chain = _explained(search, [*steps], trial, settings.longest_chain)
        if chain is None:
            break
        open_step = _better_without_name(search, step, chain)
        if open_step is not None:
            break
        for one, after in chain:
            found.append(one)
            steps.append(after)
        step = steps[-1]
    if len(found) > 1:
        _drop_needless(search, found, steps)
        step = steps[-1]
    if open_step is None and len(found) < settings.most_effects:
        for one, after in _by_any_light(search, step, steps[0]):
            found.append(one)
            steps.append(step := after)
    kept, covariance, residual = _needed(search, found, step.hypothesis), None, None
    hypothesis = step.hypothesis
    remains = _remains(search, hypothesis)
    unexplained = more_than_light(step, steps[0], remains, settings)
    verdict: Verdict = "effects" if kept else "unknown" if unexplained else "none"
    if kept:
        sure = precise(search.rig, step.hypothesis, step.screen.spread, settings, search.data)
        hypothesis, covariance = sure.hypothesis, sure.covariance
    if unexplained:
        residual = _residual(search, step, open_step)
    if residual is not None:
        hypothesis = residual.hypothesis
    return Diagnosis(verdict, tuple(kept), hypothesis, tuple(steps), covariance, residual, remains)


def _remains(search: Search, hypothesis: Hypothesis) -> Remains | None:
    """By what the recording can be told from a hypothesis, on the whole sensor; None: too few events come
    where light is known."""
    if search.sensor is None:
        return None
    search.say("Telling the recording from simulated ones, by all pixels.")
    remains = search.sensor.remains(hypothesis.parameters())
    if np.isnan(remains.evidence):
        search.say("They tell nothing: too few events come where the light is known.")
        return None
    search.say(
        f"{1000 * remains.noticed:.1f} millinats an event tell them apart, beyond what the light leaves open."
        f" In all these are {remains.evidence:.0f} nats. Where nothing is missing, the mean is"
        f" {search.settings.naming.light_nats + remains.by_larger_errors:.0f}."
    )
    return remains


def _explained(
    search: Search, steps: Sequence[SearchStep], trial: Trial, most: int, chain: int = 1
) -> list[tuple[Found, SearchStep]] | None:
    """The effects, `most` at most, each with the step after it, that explain the gap of the last of `steps`
    beginning with `trial`; None where there is too little evidence for them. chain: how many effects the
    last of these would be, with those that have not explained it alone."""
    search.say(f"Trying {trial.candidate.effect}.")
    settings, step = search.settings, steps[-1]
    after = step_of(search, trial.hypothesis, _left(search.candidates, trial.hypothesis), steps[0])
    search.say(_sentence(after))
    found = evidence(steps[-chain], after, chain, steps[0])
    search.say(_weighed(found))
    if found.enough(settings.naming):
        return [(Found(trial, step, rivals_of(settings, step, trial), found), after)]
    if most == 1:
        return None
    after = _tried(search, after)
    following = best_to_add(settings, after)
    if following is None:
        return None
    rest = _explained(search, [*steps, after], following, most - 1, chain + 1)
    if rest is None:
        return None
    one = Found(trial, step, rivals_of(settings, step, trial), rest[-1][0].evidence)
    return [(one, after), *rest]


def _tried(search: Search, step: SearchStep) -> SearchStep:
    """The step with its trials, and a word on them."""
    if step.plan is None:
        return step
    step = with_trials(search, step)
    search.say(_in_trials(step))
    return step


def _by_any_light(search: Search, step: SearchStep, first: SearchStep) -> list[tuple[Found, SearchStep]]:
    """The effect that explains what statistics of any light show, with the step after it; none where there is
    too little evidence for one, or all statistics have more left than light leaves."""
    seen = tried_in_any_light(search, step, _left(search.candidates, step.hypothesis), first)
    trial = best_to_add(search.settings, seen)
    if trial is None:
        return []
    search.say(f"Trying {trial.candidate.effect} by what is seen in any light.")
    after = step_of(search, trial.hypothesis, _left(search.candidates, trial.hypothesis), first)
    search.say(_sentence(after))
    found = evidence(seen, in_any_light(search, after), 1, in_any_light(search, first))
    search.say(_weighed(found))
    if not found.enough(search.settings.naming) or more_than_light(after, first, None, search.settings):
        return []
    return [(Found(trial, step, rivals_of(search.settings, seen, trial), found), after)]


def _weighed(found: Evidence) -> str:
    return (
        f"What is left is {np.exp(np.clip(found.log_odds, -9, 9)):.2g} times as likely if it is there as if"
        f" it stood in for something without a name; {found.wrong:.1%} of such do as well."
    )


def _better_without_name(
    search: Search, before: SearchStep, chain: Sequence[tuple[Found, SearchStep]]
) -> SearchStep | None:
    """The step at which a drift or noise without a name fits better than effects that explain a gap but
    leave some of it; None where none does."""
    last, after = chain[-1]
    if after.excess <= search.settings.proof.unnamed:
        return None
    search.say("Not all is explained: would a drift or a noise that nobody has a name for explain more?")
    opened = residual_step(search, before.hypothesis)
    confirmed = confirmed_trials(search.settings, opened)
    better = confirmed and fits_better(search.settings, before, confirmed[0], last.trial)
    return opened if better else None


def _drop_needless(search: Search, found: list[Found], steps: list[SearchStep]) -> None:
    """Take out effects without which the others explain the gap as well; one found first, for want of what
    was found later, may be such. Each time there is one step more."""
    for one in [*found]:
        step, index = steps[-1], found.index(one)
        search.say(f"Is {one.effect} needed, now that there is more?")
        bare = step.hypothesis.without(index)
        rounds = search.settings.fit.joint_rounds
        hypothesis, _ = fitted_by_simulation(search, bare, step.screen.spread.sd, rounds)
        without = step_of(search, hypothesis, _left(search.candidates, hypothesis), steps[0])
        loss = flat(search.data).size * (without.training - step.training)
        if len(found) > 1 and loss < step.least:
            found.remove(one)
            steps.append(without)
            search.say(_sentence(without))


def _residual(search: Search, step: SearchStep, opened: SearchStep | None) -> ResidualTerm | None:
    search.say("No listed effect explains what is left: looking for a drift or a noise that does.")
    if opened is None or opened.hypothesis is not step.hypothesis:
        opened = residual_step(search, step.hypothesis)
    confirmed = confirmed_trials(search.settings, opened)
    if not confirmed:
        return None
    residual = residual_of(search.settings, opened, confirmed[0])
    search.say(f"It is best said as {residual.formula}.")
    return residual


def _left(candidates: Sequence[Candidate], hypothesis: Hypothesis) -> list[Candidate]:
    """Those of which not all sizes are in the hypothesis."""
    there = {(candidate.effect, name) for candidate, _ in hypothesis.accepted for name in candidate.names}
    return [one for one in candidates if not {(one.effect, name) for name in one.names} <= there]


def _needed(search: Search, found: list[Found], hypothesis: Hypothesis) -> list[Found]:
    """Effects whose fitted size is not next to nothing."""
    kept = []
    for one, (candidate, began), now in zip(found, hypothesis.accepted, hypothesis.sizes(), strict=True):
        if candidate.times(now) > search.settings.negligible * candidate.times(began):
            kept.append(one)
    return kept


def _sentence(step: SearchStep) -> str:
    return (
        f"Gap {step.training:.2f} in training and {step.held_out:.2f} in held-out data, where chance leaves"
        f" {step.floor_training:.2f}."
    )


def _in_trials(step: SearchStep) -> str:
    if not step.trials:
        return "No effect explains more of it than chance lets one."
    return f"{step.trials[0].candidate.effect} explains most of it."
