"""One step of the search: the gap as it is, what might explain it, and how well each of these does."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .catalogue import Candidate
from .model import BASE, HELD_OUT, TRAINING, Model, flat, spread_of
from .refit import refitted
from .rig import Rig, Values
from .robust import gap
from .screen import Screen, screen_of

COARSE, TWINS, SIGNATURE, FITTING = range(500, 508), range(1000, 1028), range(2), range(4)
"""Seeds of runs: to fit the base, of the twins, for signatures, and to fit effects. 4 versions of the
light."""
ALPHA = 0.01  # chance of a name where nothing is missing, over the whole catalogue
TRIED = 3  # effects that are fitted by simulation
WORTH_TRYING = 0.25  # of the largest gain in the score test
LEAST_GAIN = 30.0  # of training loss: less could be the light between frames
LEFT_BEHIND = 0.04  # of the training loss explained so far: what an effect may leave that has another form
LARGE = 1.0  # a gap, about four times what chance leaves
FAR = 2.0  # the same, from which the score test alone says little
AS_GOOD = 15.0  # of training loss: rivals that are no worse are not told apart


@dataclass(frozen=True, eq=False)
class Trial:
    """An effect fitted to the data: gaps left in training and held-out parts."""

    candidate: Candidate
    model: Model
    gain: float  # of the score test
    training: float
    held_out: float


@dataclass(frozen=True, eq=False)
class Step:
    """Where the search stands: gaps of the model in training and held-out parts, what chance alone would
    leave (floors), the score test, the least gain of training loss that counts, and the trials, best first:
    none where gains are within chance or next to nothing."""

    model: Model
    screen: Screen
    training: float
    held_out: float
    floor_training: float
    floor_held_out: float
    gains: NDArray[np.float64]
    p_value: float
    least: float
    trials: tuple[Trial, ...]


def base_fitted(rig: Rig, model: Model, data: Values) -> Model:
    """The model with its own parameters fitted, first roughly: what v is depends on where."""
    for rounds in (1, 3):
        v = spread_of(rig, model, COARSE).v
        model = refitted(rig, model, data, v, FITTING, rounds)[0]
    return model


def step_of(
    rig: Rig, model: Model, data: Values, candidates: Sequence[Candidate], first: Step | None = None
) -> Step:
    """Look at the gap of a fitted model; first: the step before there was any effect in it."""
    spread = spread_of(rig, model, TWINS)
    screen = screen_of(rig, model, spread, candidates, SIGNATURE)
    deviation = (data - spread.mean) / spread.v
    own = screen.own(flat(deviation))
    held_out = flat(deviation, HELD_OUT) - flat(screen.base, HELD_OUT) @ own.x
    gains = screen.gains(flat(deviation))
    p_value = screen.p_value(float(gains.max()))
    training = gap(own.rest)
    least = LEAST_GAIN if first is None else max(
        LEAST_GAIN, LEFT_BEHIND * own.rest.size * (first.training - training)
    )  # fmt: skip
    worth = p_value <= ALPHA and gains.max() > least / 2
    chosen = _best(screen, gains, TRIED) if worth else []
    if worth and training > FAR:
        chosen += [index for index in _nearest(rig, screen, data) if index not in chosen]
    trials = [_trial(rig, screen, data, index, float(gains[index])) for index in chosen]
    z = [(twin - spread.mean) / spread.v for twin in spread.twins]
    floor_training, floor_held_out = (
        float(np.mean([gap(flat(one, parts)) for one in z])) for parts in (TRAINING, HELD_OUT)
    )
    if trials:
        best = min(trials, key=lambda trial: trial.training)
        trials[trials.index(best)] = _judged(
            rig, screen, data, best.candidate, best.model, best.gain, rounds=3
        )
    return Step(
        model, screen, training, gap(held_out), floor_training, floor_held_out, gains,
        p_value, least, tuple(sorted(trials, key=lambda trial: trial.training)),
    )  # fmt: skip


def _best(screen: Screen, gains: NDArray[np.float64], tried: int) -> list[int]:
    """The signatures of the highest gains, one for each candidate."""
    chosen: dict[tuple[str, tuple[str, ...]], int] = {}
    for index in np.argsort(-gains):
        one = screen.signatures[index].candidate
        if gains[index] > WORTH_TRYING * gains.max():
            chosen.setdefault((one.effect, one.names), int(index))
    return list(chosen.values())[:tried]


def _nearest(rig: Rig, screen: Screen, data: Values) -> list[int]:
    """The signatures of the effects that leave least of the gap when they are added to the camera file, base
    parameters as they are there: with a strong effect missing, the fitted ones mean nothing."""
    start = _from_file(screen.model)
    means = rig.means(
        [one.candidate.on(start.parameters(), one.size) for one in screen.signatures], SIGNATURE
    )
    left = np.array([gap(flat((data - mean) / screen.spread.v)) for mean in means])
    return _best(screen, left.max() - left, 2)


def _trial(rig: Rig, screen: Screen, data: Values, index: int, gain: float) -> Trial:
    """The effect fitted by simulation, from where the score test has it.

    With a large gap that is too far for a straight line, and the base may have gone astray for want of the
    effect: it is fitted from the camera file, too, if that is nearer.
    """
    one, v, model = screen.signatures[index], screen.spread.v, screen.model
    z = flat((data - screen.spread.mean) / v)
    amounts = screen.with_effect(z, one).x
    size = one.candidate.scaled(one.size, float(np.clip(amounts[-1], 0.03, 3)))
    base = np.array(model.shift) + np.clip(amounts[:-1], -0.5, 0.5)
    starts = [replace(model, shift=tuple(base.tolist())).with_effect(one.candidate, size)]
    if gap(z) > LARGE:
        sizes = [one.candidate.scaled(each, more) for each in one.candidate.sizes for more in (1, 2.5)]
        starts += [_from_file(model).with_effect(one.candidate, each) for each in (size, *sizes)]
    means = rig.means([start.parameters() for start in starts], FITTING)
    nearest = int(np.argmin([gap(flat((data - mean) / v)) for mean in means]))
    return _judged(rig, screen, data, one.candidate, starts[nearest], gain)


def _from_file(model: Model) -> Model:
    """The model with base parameters as in the camera file."""
    return replace(model, shift=(0.0,) * len(BASE) + model.shift[len(BASE) :])


def _judged(
    rig: Rig, screen: Screen, data: Values, candidate: Candidate, start: Model, gain: float, rounds: int = 1
) -> Trial:
    model, mean = refitted(rig, start, data, screen.spread.v, FITTING, rounds)
    z = (data - mean) / screen.spread.v
    return Trial(candidate, model, gain, gap(flat(z)), gap(flat(z, HELD_OUT)))
