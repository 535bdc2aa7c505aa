"""An effect tried: fitted to the data by simulation, and how much of the gap it explains."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values
from ..catalogue.candidate import Candidate
from .fit import fitted_by_simulation
from .hypothesis import Hypothesis
from .robust import mean_huber, robust_fit
from .screen import LIGHT, Screen, Signature
from .spread import HELD_OUT, TRAINING, Slopes, flat, slopes_of
from .state import Search


@dataclass(frozen=True, eq=False)
class Trial:
    """An effect fitted to the data: the statistics it gives on average, the gaps it leaves in training and
    held-out parts, and by how much it lessens them (gained, confirmed), less what its own scatter costs; all
    by the statistics that the screen sees.

    score: its gain in the score test."""

    candidate: Candidate
    hypothesis: Hypothesis
    mean: Values
    score: float
    training: float
    held_out: float
    gained: float
    confirmed: float


@dataclass(frozen=True, eq=False)
class TrialBench:
    """Where effects are tried. rest: (PARTS, n) deviations of the data that base parameters do not take
    up, in units of the inflated sd. at_chance: the training gap of a fit that needs no second one."""

    search: Search
    screen: Screen
    rest: Values
    at_chance: float

    def tried(self, index: int, score: float) -> Trial:
        """The effect of a signature, from where the score test has it.

        With a large gap a straight line does not reach that far, and base parameters may stand in for the
        effect. Then the fit begins at the best of several places: amounts of the signature with the base
        following, and the camera file. Where the base is off its prior it is fitted from the file besides:
        near where the base has gone there may be no size of the effect that helps.
        """
        one, sd, hypothesis = (
            self.screen.signatures[index], self.screen.spread.inflated_sd, self.screen.hypothesis
        )  # fmt: skip
        trials, huber_z = self.search.settings.trials, self.search.settings.huber_z
        z = self.screen.flat((self.search.data - self.screen.spread.mean) / sd)
        amounts = self.screen.with_effect(z, one).x
        size = one.candidate.scaled(one.size, float(np.clip(amounts[-1], *trials.amount_limits)))
        move = np.clip(amounts[: -LIGHT - 1], -trials.base_limit, trials.base_limit)
        starts = [hypothesis.moved(move).with_effect(one.candidate, size)]
        if mean_huber(z, huber_z) > trials.large_gap:
            starts += [
                hypothesis.with_base_of_file().with_effect(one.candidate, size),
                *self._from_file(one.candidate),
            ]
            starts += [self._followed(one, z, amount) for amount in trials.amounts]
        trial = self.judged(one.candidate, self._nearest(starts), score, trials.rounds)
        if not hypothesis.off_prior(self.search.settings):
            return trial
        start = self._nearest(self._from_file(one.candidate))
        return max(trial, self.judged(one.candidate, start, score, trials.rounds), key=_gained)

    def _followed(self, one: Signature, z: NDArray[np.float64], amount: float) -> Hypothesis:
        """The hypothesis with so much of a signature, its own parameters where they leave the least loss
        then."""
        longest, column = self.search.settings.fit.longest_step, self.screen.flat(one.column)
        move = np.clip(self.screen.own(z - amount * column).x[:-LIGHT], -longest, longest)
        moved = self.screen.hypothesis.moved(move)
        return moved.with_effect(one.candidate, one.candidate.scaled(one.size, amount))

    def _slopes(self, start: Hypothesis) -> Slopes:
        """About what they are at the start of a trial: the effect's own are, those of what was there are as
        without it."""
        settings, known = self.search.settings, self.screen.spread.slopes
        own = slopes_of(self.search.rig, start, settings.runs.slopes, settings, known.shape[-1])
        return np.concatenate([known, own], axis=-1)

    def judged(self, candidate: Candidate, start: Hypothesis, score: float, rounds: int) -> Trial:
        """An effect fitted from `start` on; rounds: for which slopes are taken anew there.

        Few hot pixels scatter more than all twins without any: where an effect brings a scatter of its own,
        what it leaves counts in units of that, and the logarithm of the scatter is added, as in a likelihood:
        else the widest would explain most.
        """
        search, spread, trials = self.search, self.screen.spread, self.search.settings.trials
        sd, huber_z = spread.inflated_sd, search.settings.huber_z
        slopes = None if rounds else self._slopes(start)
        hypothesis, mean = fitted_by_simulation(search, start, sd, rounds, slopes)
        rough = search.rig.runs([hypothesis.parameters()], search.settings.runs.rough_twins)[0]
        scatter = rough.std(axis=0, ddof=1)
        wide = np.where(scatter > trials.scatter * sd, scatter, sd)
        if np.mean((wide > sd)[:, self.screen.seen]) > trials.scattered_share:
            slopes = None if rounds else self._slopes(hypothesis)
            hypothesis, mean = fitted_by_simulation(search, hypothesis, wide, rounds, slopes)
        after, wider = self._without_light(search.data - mean, wide), np.log(wide / sd)
        gained, confirmed = (
            mean_huber(self.screen.flat(self.rest, parts), huber_z)
            - mean_huber(self.screen.flat(after / wide, parts), huber_z)
            - float(self.screen.flat(wider, parts).mean())
            for parts in (TRAINING, HELD_OUT)
        )
        not_inflated = np.where(scatter > trials.scatter * sd, scatter, spread.sd)
        training, held_out = (
            mean_huber(self.screen.flat(after / not_inflated, parts), huber_z)
            for parts in (TRAINING, HELD_OUT)
        )
        return Trial(candidate, hypothesis, mean, score, training, held_out, gained, confirmed)

    def _without_light(self, deviation: Values, sd: Values) -> Values:
        """Deviations (PARTS, n) less what the light's errors take up; sd: the units of the fit."""
        settings = self.search.settings
        light = self.screen.base[..., -LIGHT:] * self.screen.spread.inflated_sd[..., None]
        found = robust_fit(
            flat(deviation / sd), flat(light / sd[..., None]), np.ones(LIGHT), settings.huber_z,
            settings.fit.reweightings,
        )  # fmt: skip
        return np.asarray(deviation - light @ found.x)

    def again(self, trial: Trial) -> Trial:
        """The trial, or the effect fitted from the size nearest to it and the base without it, if that is
        better: either may stop in a valley of its own."""
        if trial.training <= self.at_chance:
            return trial
        rounds = self.search.settings.trials.rounds
        other = self.judged(trial.candidate, self._start(trial), trial.score, rounds)
        return max(trial, other, key=_gained)

    def finished(self, best: Trial) -> Trial:
        """The trial fitted to the end: the best of where it is, the nearest size, and the camera file, as
        base parameters may have gone far to stand in for the effect."""
        trials, ends = self.search.settings.trials, [best]
        if best.training > self.at_chance:
            starts = [self._start(best), self._nearest(self._from_file(best.candidate))]
            ends += self.search.rig.each(
                lambda one: self.judged(best.candidate, one, best.score, trials.rounds), starts
            )
        begin = max(ends, key=_gained)
        end = self.judged(best.candidate, begin.hypothesis, best.score, trials.last_rounds)
        return max(begin, end, key=_gained)

    def _from_file(self, candidate: Candidate) -> list[Hypothesis]:
        """The effect at several sizes, base parameters as in the camera file."""
        amounts = self.search.settings.trials.file_amounts
        sizes = [candidate.scaled(each, amount) for each in candidate.sizes for amount in amounts]
        return [self.screen.hypothesis.with_base_of_file().with_effect(candidate, size) for size in sizes]

    def _nearest(self, starts: Sequence[Hypothesis]) -> Hypothesis:
        """That which leaves the least gap as it is."""
        search = self.search
        means = search.rig.means([start.parameters() for start in starts], search.settings.runs.fitting)
        z = [self.screen.flat((search.data - mean) / self.screen.spread.inflated_sd) for mean in means]
        return starts[int(np.argmin([mean_huber(one, search.settings.huber_z) for one in z]))]

    def _start(self, trial: Trial) -> Hypothesis:
        one, found = trial.candidate, trial.hypothesis.sizes()[-1]
        alike = [size for size in one.sizes if size[0] * found[0] > 0]  # a fit does not change the sign
        nearest = min(alike, key=lambda size: abs(np.log(size[0] / found[0])))
        return self.screen.hypothesis.with_effect(one, nearest)


def _gained(trial: Trial) -> float:
    return trial.gained
