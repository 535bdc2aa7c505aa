"""A second look, by the statistics of any light alone: light between frames has no part in these."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..catalogue.candidate import Candidate
from .left import most_left
from .screen import VIEWS
from .state import Search
from .step import SearchStep, TrialPlan, untried, with_trials


def in_any_light(search: Search, step: SearchStep) -> SearchStep:
    """The same step as these statistics see it."""
    return untried(search, step.screen.in_any_light)


def tried_in_any_light(
    search: Search, step: SearchStep, candidates: Sequence[Candidate], first: SearchStep
) -> SearchStep:
    """The same with trials of what is more than chance. first: the step before any effect was found.

    Where all statistics show more than light leaves, only effects are tried that were seen to leave no more.
    A further effect has to be as sure as one by all statistics.
    """
    test, other = search.settings.score_test, in_any_light(search, step)
    alpha = test.alpha
    if step is not first:
        alpha, statistics = test.next_alpha, other.screen.flat(other.rest).size
        explained = statistics * (in_any_light(search, first).training - other.training)
        least = max(other.screen.chance.gain_of(alpha / VIEWS), test.least_gain_share * explained)
        other = replace(other, least=least)
    most = step.floor_training + most_left(step, first, search.settings) + search.settings.proof.few_runs
    able = [trial.candidate for trial in step.trials if trial.training <= most]
    worth = [step.training <= most or one.candidate in able for one in other.screen.signatures]
    other = replace(other, scores=np.where(worth, other.scores, 0.0))
    plan = TrialPlan(tuple(candidates), alpha, test.tried_share * other.least)
    return with_trials(search, replace(other, plan=plan))
