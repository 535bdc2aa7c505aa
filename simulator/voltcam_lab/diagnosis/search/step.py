"""One step of the search: the gap as it is, what might explain it, and how well each of these does."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..catalogue.candidate import Candidate
from ..rig.rig import Rig, Values
from .model import BASE, HELD_OUT, SHARP, TRAINING, Model, flat, spread_of
from .refit import refitted
from .robust import gap, loss
from .screen import Screen, screen_of
from .trial import COARSE, FITTING, Bench, Trial, from_file

TWINS, SIGNATURE = range(1000, 1028), range(2)
"""Seeds of runs: of the twins, and for signatures."""
ALPHA = 0.01  # chance of a name where nothing is missing, over the whole catalogue
TRIED = 3  # effects that are fitted by simulation
WORTH_TRYING = 0.25  # of the largest gain in the score test
LEAST_GAIN = 30.0  # of training loss: less could be the light between frames
NEXT_ALPHA = 1e-4  # the same of a further one: what is in the model has not quite the form of what is there
LEFT_BEHIND = 0.04  # of the training gap explained so far: what an effect may leave that has another form
LEFT_OVER = 0.01  # the same, in a single other effect's direction
FAR = 2.0  # a gap, eight times what chance leaves, from which the score test alone says little
NEARLY = 0.7  # of the best: what seems that good is fitted a second time
AT_CHANCE = 0.1  # of the gap over its floor: an effect that leaves no more has found its valley
AS_GOOD = 15.0  # of training loss: rivals that are no worse are not told apart
DOUBT = 2.0  # the same, for each unit of the distance between what two effects do: losses scatter by that


@dataclass(frozen=True, eq=False)
class Step:
    """Where the search stands: gaps of the model in training and held-out parts, what chance alone would
    leave (floors), the score test, the least gain of training loss that counts, and the trials, best first:
    none where gains are within chance or next to nothing. rest: (PARTS, n) deviations that base parameters do
    not take up, in units of v as gaps are; chance: the mean loss of twins, by statistic."""

    model: Model
    screen: Screen
    rest: Values
    chance: Values
    training: float
    held_out: float
    floor_training: float
    floor_held_out: float
    gains: NDArray[np.float64]
    p_value: float
    least: float
    trials: tuple[Trial, ...]

    @property
    def excess(self) -> float:
        """The training gap over what chance leaves."""
        return self.training - self.floor_training


def base_fitted(rig: Rig, model: Model, data: Values) -> Model:
    """The model with its own parameters fitted, first roughly: what v is depends on where.

    From the file of another camera the way is long, and at first anything that leads down is taken along:
    noise and the leak in the dark, which show where the rest is right, start from the file once more.
    """
    fit = _base_refitted(rig, _base_refitted(rig, model, data, rounds=1), data, rounds=3)
    if not fit.astray:
        return fit
    near = np.where([name in SHARP for _, name in BASE], fit.shift, model.shift)
    return _base_refitted(rig, replace(model, shift=tuple(near.tolist())), data, rounds=3)


def _base_refitted(rig: Rig, model: Model, data: Values, rounds: int) -> Model:
    v = spread_of(rig, model, COARSE).v
    return refitted(rig, model, data, v, FITTING, rounds)[0]


def step_of(
    rig: Rig, model: Model, data: Values, candidates: Sequence[Candidate], first: Step | None = None
) -> Step:
    """Look at the gap of a fitted model; first: the step before there was any effect in it."""
    spread = spread_of(rig, model, TWINS)
    screen = screen_of(rig, model, spread, candidates, SIGNATURE)
    deviation = (data - spread.mean) / spread.lenient
    left = deviation - screen.base @ screen.own(flat(deviation)).x
    rest = left * (spread.lenient / spread.v)
    gains = screen.gains(flat(deviation))
    p_value = screen.p_value(float(gains.max()))
    training = gap(flat(rest))
    least = LEAST_GAIN if first is None else max(
        LEAST_GAIN, LEFT_OVER * flat(rest).size * (first.training - training)
    )  # fmt: skip
    beyond = (ALPHA, least / 2) if first is None else (NEXT_ALPHA, least)
    worth = p_value <= beyond[0] and gains.max() > beyond[1]
    chosen = _best(screen, gains, TRIED) if worth else []
    if worth and training > FAR:
        chosen += [index for index in _nearest(rig, screen, data, training) if index not in chosen]
    if worth and model.astray:
        chosen += [index for index in _best_on_file(rig, model, data, candidates) if index not in chosen]
    chance = np.mean([loss(z) for z in spread.left_out], axis=0)
    floor_training, floor_held_out = (float(flat(chance, parts).mean()) for parts in (TRAINING, HELD_OUT))
    bench = Bench(rig, screen, data, left, floor_training + AT_CHANCE)
    trials = rig.each(lambda index: bench.tried(index, float(gains[index])), chosen)
    if trials:
        most = max(trial.gained for trial in trials)
        seem = [one.gained > NEARLY * most or one.gain > NEARLY * gains.max() for one in trials]
        again = iter(rig.each(bench.anew, [one for one, good in zip(trials, seem, strict=True) if good]))
        trials = [next(again) if good else one for one, good in zip(trials, seem, strict=True)]
        best = max(trials, key=lambda trial: trial.gained)
        trials[trials.index(best)] = bench.settled(best)
    return Step(
        model, screen, rest, chance, training, gap(flat(rest, HELD_OUT)), floor_training, floor_held_out,
        gains, p_value, least, tuple(sorted(trials, key=lambda trial: -trial.gained)),
    )  # fmt: skip


def _best(screen: Screen, gains: NDArray[np.float64], tried: int) -> list[int]:
    """The signatures of the highest gains, one for each candidate."""
    chosen: dict[tuple[object, ...], int] = {}
    for index in np.argsort(-gains):
        one = screen.signatures[index].candidate
        if gains[index] > WORTH_TRYING * gains.max():
            chosen.setdefault((one.effect, one.names, *one.others.items()), int(index))
    return list(chosen.values())[:tried]


def _nearest(rig: Rig, screen: Screen, data: Values, training: float) -> list[int]:
    """The signatures of the effects that leave less of a gap when they are added to the camera file, base
    parameters as they are there: with a strong effect missing, the fitted ones mean nothing."""
    start = from_file(screen.model)
    means = rig.means(
        [one.candidate.on(start.parameters(), one.size) for one in screen.signatures], SIGNATURE
    )
    left = np.array([gap(flat((data - mean) / screen.spread.v)) for mean in means])
    return _best(screen, np.maximum(training - left, 0), 2)


def _best_on_file(rig: Rig, model: Model, data: Values, candidates: Sequence[Candidate]) -> list[int]:
    """The signatures that score highest on the camera file: for want of what is there the base may have gone
    astray, to where other effects seem nearer."""
    start = from_file(model)
    spread = spread_of(rig, start, COARSE)
    screen = screen_of(rig, start, spread, candidates, SIGNATURE)
    return _best(screen, screen.gains(flat((data - spread.mean) / spread.lenient)), 2)
