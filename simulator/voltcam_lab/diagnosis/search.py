"""One step of the search: the gap as it is, what might explain it, and how well each of these does."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .catalogue import Candidate
from .model import HELD_OUT, TRAINING, Model, flat, refitted, spread_of
from .rig import Rig, Values
from .robust import gap
from .screen import Screen, screen_of

COARSE, TWINS, SIGNATURE, FITTING = range(500, 508), range(1000, 1028), range(2), range(4)
"""Seeds of runs: to fit the base, of the twins, for signatures, and to fit effects. 4 versions of the
light."""
TRIED = 3  # effects that are fitted by simulation
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
    leave (floors), the score test, and the trials, best first."""

    model: Model
    screen: Screen
    training: float
    held_out: float
    floor_training: float
    floor_held_out: float
    gains: NDArray[np.float64]
    p_value: float
    trials: tuple[Trial, ...]


def base_fitted(rig: Rig, model: Model, data: Values) -> Model:
    """The model with its own parameters fitted, first roughly: what v is depends on where."""
    for rounds in (1, 3):
        v = spread_of(rig, model.parameters(), COARSE).v
        model = refitted(rig, model, data, v, FITTING, rounds)[0]
    return model


def step_of(
    rig: Rig, model: Model, data: Values, candidates: Sequence[Candidate], tried: int = TRIED
) -> Step:
    """Look at the gap of a fitted model."""
    spread = spread_of(rig, model.parameters(), TWINS)
    screen = screen_of(rig, model, spread, candidates, SIGNATURE)
    deviation = (data - spread.mean) / spread.v
    own = screen.own(flat(deviation))
    held_out = flat(deviation, HELD_OUT) - flat(screen.base, HELD_OUT) @ own.x
    gains = screen.gains(flat(deviation))
    trials = [_trial(rig, screen, data, index, float(gains[index])) for index in _best(screen, gains, tried)]
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
        model, screen, gap(own.rest), gap(held_out), floor_training, floor_held_out, gains,
        screen.p_value(float(gains.max())), tuple(sorted(trials, key=lambda trial: trial.training)),
    )  # fmt: skip


def _best(screen: Screen, gains: NDArray[np.float64], tried: int) -> list[int]:
    """The signatures of the highest gains, one for each candidate."""
    chosen: dict[tuple[str, tuple[str, ...]], int] = {}
    for index in np.argsort(-gains):
        one = screen.signatures[index].candidate
        if gains[index] > 0:
            chosen.setdefault((one.effect, one.names), int(index))
    return list(chosen.values())[:tried]


def _trial(rig: Rig, screen: Screen, data: Values, index: int, gain: float) -> Trial:
    """The effect fitted by simulation, from where the score test has it."""
    one, v = screen.signatures[index], screen.spread.v
    amounts = screen.with_effect(flat((data - screen.spread.mean) / v), one).x
    size = one.candidate.scaled(one.size, float(np.clip(amounts[-1], 0.03, 3)))
    base = np.array(screen.model.shift) + np.clip(amounts[:-1], -0.5, 0.5)
    start = replace(screen.model, shift=tuple(base.tolist())).with_effect(one.candidate, size)
    return _judged(rig, screen, data, one.candidate, start, gain)


def _judged(
    rig: Rig, screen: Screen, data: Values, candidate: Candidate, start: Model, gain: float, rounds: int = 1
) -> Trial:
    model, mean = refitted(rig, start, data, screen.spread.v, FITTING, rounds)
    z = (data - mean) / screen.spread.v
    return Trial(candidate, model, gain, gap(flat(z)), gap(flat(z, HELD_OUT)))
