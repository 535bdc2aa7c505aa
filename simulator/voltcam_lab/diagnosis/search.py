"""One step of the search: the gap as it is, what might explain it, and how well each of these does."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .catalogue import Candidate
from .model import HELD_OUT, Model, flat, refitted, spread_of
from .rig import Rig, Values
from .robust import gap
from .screen import Screen, screen_of

COARSE, TWINS, SIGNATURE, FITTING = range(500, 512), range(1000, 1032), range(2), range(4)
"""Seeds of runs: to fit the base, of the twins, for signatures, and to fit effects. 4 versions of the light."""
TRIED = 4  # effects that are fitted by simulation


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
    """Where the search stands: gaps of the model in training and held-out parts, what chance alone would leave
    (floors), the score test, and the trials, best first."""

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
    """The model with its own parameters fitted."""
    return refitted(rig, model, data, spread_of(rig, model.parameters(), COARSE).v, FITTING)[0]


def step_of(rig: Rig, model: Model, data: Values, candidates: Sequence[Candidate], tried: int = TRIED) -> Step:
    """Look at the gap of a fitted model."""
    spread = spread_of(rig, model.parameters(), TWINS)
    screen = screen_of(rig, model, spread, candidates, SIGNATURE)
    deviation = (data - spread.mean) / spread.v
    own = screen.own(flat(deviation))
    held_out = flat(deviation, HELD_OUT) - flat(screen.base, HELD_OUT) @ own.x
    gains = screen.gains(flat(deviation))
    trials = [
        _trial(rig, screen, data, signature_index, float(gains[signature_index]))
        for signature_index in _best(screen, gains, tried)
    ]
    floors = [float(np.mean([gap(flat((twin - spread.mean) / spread.v, parts)) for twin in spread.twins]))
              for parts in ((0, 1, 2), HELD_OUT)]  # fmt: skip
    return Step(
        model, screen, gap(own.rest), gap(held_out), *floors, gains, screen.p_value(float(gains.max())),
        tuple(sorted(trials, key=lambda trial: trial.training)),
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
    one = screen.signatures[index]
    model, mean = refitted(rig, screen.model.with_effect(one.candidate, one.size), data, screen.spread.v, FITTING)
    z = (data - mean) / screen.spread.v
    return Trial(one.candidate, model, gain, gap(flat(z)), gap(flat(z, HELD_OUT)))

