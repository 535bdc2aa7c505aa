"""One step of the search: the gap as it is, what might explain it, and how well each of these does."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values
from ..catalogue.candidate import Candidate
from .fit import fitted_by_simulation
from .hypothesis import BASE, Hypothesis
from .robust import huber, mean_huber
from .screen import VIEWS, Screen, screen_of
from .spread import HELD_OUT, TRAINING, spread_of
from .state import Search
from .trial import Trial, TrialBench


@dataclass(frozen=True)
class TrialPlan:
    """Which effects are to be tried, if a score has so small a p-value, and is as large."""

    candidates: tuple[Candidate, ...]
    alpha: float
    least_score: float


@dataclass(frozen=True, eq=False)
class SearchStep:
    """Where the search is: gaps of the hypothesis in training and held-out parts, what chance alone would
    leave (floors), the scores of the score test, the least training loss that counts, and the trials, best
    first: none where scores are within chance or next to nothing. All of these are by the statistics that the
    screen sees; the p-value of one that sees all is that of both views. rest: (PARTS, n) deviations that base
    parameters do not take up, in units of the sd; chance: (PARTS, n) the mean loss of twins. plan: of trials
    that have not been made, see `with_trials`: they take most of the time, and many a step needs none."""

    hypothesis: Hypothesis
    screen: Screen
    rest: Values
    chance: Values
    training: float
    held_out: float
    floor_training: float
    floor_held_out: float
    scores: NDArray[np.float64]
    p_value: float
    least: float
    trials: tuple[Trial, ...] = ()
    plan: TrialPlan | None = None

    @property
    def excess(self) -> float:
        """The training gap over what chance leaves."""
        return self.training - self.floor_training


def base_fitted(search: Search, hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis with its own parameters fitted, first roughly, as the sd depends on them.

    From the file of another camera the way is long, and at first anything that lowers the gap is taken along.
    Noise and the leak in the dark show only where the rest is right: they start from the file once more.
    """
    settings = search.settings
    rough = _base_refitted(search, hypothesis, settings.fit.rough_rounds)
    fit = _base_refitted(search, rough, settings.fit.base_rounds)
    if not fit.off_prior(settings):
        return fit
    sharp = settings.derivatives.sharp
    near = np.where([name in sharp for _, name in BASE], fit.shift, hypothesis.shift)
    return _base_refitted(search, replace(hypothesis, shift=tuple(near.tolist())), settings.fit.base_rounds)


def _base_refitted(search: Search, hypothesis: Hypothesis, rounds: int) -> Hypothesis:
    settings = search.settings
    sd = spread_of(search.rig, hypothesis, settings.runs.rough_twins, settings).sd
    return fitted_by_simulation(search, hypothesis, sd, rounds)[0]


def step_of(
    search: Search,
    hypothesis: Hypothesis,
    candidates: Sequence[Candidate] | None = None,
    first: SearchStep | None = None,
) -> SearchStep:
    """Look at the gap of a fitted hypothesis; its trials are planned. candidates: in place of all. first: the
    step before there was any effect in it."""
    settings = search.settings
    candidates = tuple(search.candidates if candidates is None else candidates)
    spread = spread_of(search.rig, hypothesis, settings.runs.twins, settings)
    screen = screen_of(search.rig, hypothesis, spread, candidates, settings)
    step = untried(search, screen)
    step = replace(step, p_value=min(step.p_value, untried(search, screen.in_any_light).p_value))
    test = settings.score_test
    if first is None:
        return replace(step, plan=TrialPlan(candidates, test.alpha, test.tried_share * step.least))
    least = test.least_gain_share * screen.flat(step.rest).size * (first.training - step.training)
    least = max(step.least, least)
    return replace(step, least=least, plan=TrialPlan(candidates, test.next_alpha, least))


def untried(search: Search, screen: Screen) -> SearchStep:
    """The gap of a hypothesis, and what might be in it, by the statistics that a screen sees."""
    settings, spread, data = search.settings, screen.spread, search.data
    deviation = (data - spread.mean) / spread.inflated_sd
    z = screen.flat(deviation)
    rest = (deviation - screen.base @ screen.own(z).x) * (spread.inflated_sd / spread.sd)
    chance = np.mean([huber(z, settings.huber_z) for z in spread.left_out], axis=0)
    parts = TRAINING, HELD_OUT
    training, held_out = (mean_huber(screen.flat(rest, part), settings.huber_z) for part in parts)
    floor_training, floor_held_out = (float(screen.flat(chance, part).mean()) for part in parts)
    least = settings.score_test.least_gain
    if not screen.seen.all():
        least = screen.chance.gain_of(settings.score_test.alpha / VIEWS)
    return SearchStep(
        screen.hypothesis, screen, rest, chance, training, held_out, floor_training, floor_held_out,
        screen.gains(z), screen.p_value(z), least,
    )  # fmt: skip


def with_trials(search: Search, step: SearchStep) -> SearchStep:
    """The step with the trials that are planned, if there are such."""
    plan, step = step.plan, replace(step, plan=None)
    if plan is None or step.p_value > plan.alpha or step.scores.max() <= plan.least_score:
        return step
    spread = step.screen.spread
    bench = TrialBench(
        search, step.screen, step.rest * (spread.sd / spread.inflated_sd),
        step.floor_training + search.settings.trials.at_chance,
    )  # fmt: skip
    chosen = _chosen(search, step.screen, plan.candidates, step.scores, step.training)
    return replace(step, trials=_trials(bench, chosen, step.scores))


def _trials(
    bench: TrialBench, chosen: Sequence[Sequence[int]], scores: NDArray[np.float64]
) -> tuple[Trial, ...]:
    """The chosen effects fitted, the best of them to the end; best first. While all leave more than light
    does, further ones are tried: an effect that was not tried cannot be told from the best that was."""
    rig, settings, nearly = bench.search.rig, bench.search.settings, bench.search.settings.trials.nearly_best
    trials: list[Trial] = []
    for some in chosen:
        trials += rig.each(lambda index: bench.tried(index, float(scores[index])), some)
        if min(trial.training for trial in trials) <= bench.at_chance + settings.most_by_light:
            break
    if trials:
        most = max(trial.gained for trial in trials)
        good = [one.gained > nearly * most or one.score > nearly * scores.max() for one in trials]
        again = iter(rig.each(bench.again, [one for one, well in zip(trials, good, strict=True) if well]))
        trials = [next(again) if well else one for one, well in zip(trials, good, strict=True)]
        best = max(trials, key=lambda trial: trial.gained)
        trials[trials.index(best)] = bench.finished(best)
    return tuple(sorted(trials, key=lambda trial: -trial.gained))


def _chosen(
    search: Search,
    screen: Screen,
    candidates: Sequence[Candidate],
    scores: NDArray[np.float64],
    training: float,
) -> list[list[int]]:
    """Numbers of the signatures that are tried, some at a time: of the best scores, and, where these say
    little, others beside the first."""
    most = search.settings.trials.at_a_time
    scored = _best(screen, scores)
    first = scored[:most]
    if training > search.settings.trials.far_gap:
        first += [index for index in _nearest_from_file(search, screen, training) if index not in first]
    if screen.hypothesis.off_prior(search.settings):
        on_file = _best_on_file(search, screen.hypothesis, candidates)
        first += [index for index in on_file if index not in first]
    others = [index for index in scored if index not in first]
    return [first, *(others[k : k + most] for k in range(0, len(others), most))]


def _best(screen: Screen, scores: NDArray[np.float64]) -> list[int]:
    """The signatures of the highest scores, best first, one for each candidate."""
    chosen: dict[tuple[object, ...], int] = {}
    for index in np.argsort(-scores):
        one = screen.signatures[index].candidate
        if scores[index] > screen.settings.trials.least_score * scores.max():
            chosen.setdefault((one.effect, one.names, *one.others.items()), int(index))
    return list(chosen.values())


def _nearest_from_file(search: Search, screen: Screen, training: float) -> list[int]:
    """The signatures of the effects that leave less of a gap when they are added to the camera file, base
    parameters as they are there: with a strong effect missing, the fitted ones mean nothing."""
    start, settings = screen.hypothesis.with_base_of_file(), search.settings
    means = search.rig.means(
        [one.candidate.on(start.parameters(), one.size) for one in screen.signatures],
        settings.runs.signatures,
    )
    left = np.array(
        [mean_huber(screen.flat((search.data - mean) / screen.spread.sd), settings.huber_z) for mean in means]
    )
    return _best(screen, np.maximum(training - left, 0))[: settings.trials.most_from_file]


def _best_on_file(search: Search, hypothesis: Hypothesis, candidates: Sequence[Candidate]) -> list[int]:
    """The signatures that score highest on the camera file: fitted base parameters that stand in for an
    effect may be where other effects seem nearer."""
    start, settings = hypothesis.with_base_of_file(), search.settings
    spread = spread_of(search.rig, start, settings.runs.rough_twins, settings)
    screen = screen_of(search.rig, start, spread, candidates, settings)
    scores = screen.gains(screen.flat((search.data - spread.mean) / spread.inflated_sd))
    return _best(screen, scores)[: settings.trials.most_from_file]
