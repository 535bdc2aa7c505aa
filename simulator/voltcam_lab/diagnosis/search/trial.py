"""An effect tried: fitted to the data by simulation, and how much of the gap it explains."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..catalogue.candidate import Candidate
from ..rig.rig import Rig, Values
from .model import BASE, HELD_OUT, TRAINING, Model, flat
from .refit import FURTHEST, refitted
from .robust import gap
from .screen import Screen, Signature

COARSE, FITTING = range(500, 508), range(4)
"""Seeds of runs: for a rough spread, and to fit. 4 versions of the light."""
LARGE = 1.0  # a gap, about four times what chance leaves
AMOUNTS = (0.4, 1.0, 2.5)  # of a signature
SCATTERS = 2.0  # times the spread without the effect


@dataclass(frozen=True, eq=False)
class Trial:
    """An effect fitted to the data: what the battery sees then on average, the gaps it leaves in training and
    held-out parts, and by how much it lessens them, less what its own scatter costs.

    gain: of the score test."""

    candidate: Candidate
    model: Model
    mean: Values
    gain: float
    training: float
    held_out: float
    gained: float
    confirmed: float


@dataclass(frozen=True, eq=False)
class Bench:
    """Where effects are tried. rest: (PARTS, n) deviations of the data that base parameters do not take
    up, in units of the lenient spread. at_chance: the training gap of a fit that needs no second one."""

    rig: Rig
    screen: Screen
    data: Values
    rest: Values
    at_chance: float

    def tried(self, index: int, gain: float) -> Trial:
        """The effect of a signature, from where the score test has it.

        With a large gap that is too far for a straight line, and the base may have gone astray for want of
        the effect: it is fitted from where the base follows on a straight line at sizes of AMOUNTS, or from
        the camera file, if that is nearer. Where the base has gone astray it is fitted from the file in any
        case: where the base has gone is nearer than any size of an effect on the file.
        """
        one, v, model = self.screen.signatures[index], self.screen.spread.lenient, self.screen.model
        z = flat((self.data - self.screen.spread.mean) / v)
        amounts = self.screen.with_effect(z, one).x
        size = one.candidate.scaled(one.size, float(np.clip(amounts[-1], 0.03, 3)))
        base = np.array(model.shift) + np.clip(amounts[:-1], -0.5, 0.5)
        starts = [replace(model, shift=tuple(base.tolist())).with_effect(one.candidate, size)]
        if gap(z) > LARGE:
            starts += [from_file(model).with_effect(one.candidate, size), *self._from_file(one.candidate)]
            starts += [self._followed(one, z, amount) for amount in AMOUNTS]
        trial = self.judged(one.candidate, self._nearest(starts), gain)
        if not model.astray:
            return trial
        start = self._nearest(self._from_file(one.candidate))
        return max(trial, self.judged(one.candidate, start, gain), key=_gained)

    def _followed(self, one: Signature, z: NDArray[np.float64], amount: float) -> Model:
        """The model with so much of a signature, its own parameters where they leave the least loss then."""
        model, rest = self.screen.model, z - amount * flat(one.column)
        shift = np.array(model.shift) + np.clip(self.screen.own(rest).x, -FURTHEST, FURTHEST)
        moved = replace(model, shift=tuple(shift.tolist()))
        return moved.with_effect(one.candidate, one.candidate.scaled(one.size, amount))

    def judged(self, candidate: Candidate, start: Model, gain: float, rounds: int = 1) -> Trial:
        """An effect fitted from `start` on.

        Few hot pixels scatter more than all twins without any: where an effect brings a scatter of its own,
        what it leaves counts in units of that, and the logarithm of the scatter is added, as in a likelihood:
        else the widest would explain most.
        """
        spread, v = self.screen.spread, self.screen.spread.lenient
        model, mean = refitted(self.rig, start, self.data, v, FITTING, rounds)
        sd = self.rig.runs([model.parameters()], COARSE)[0].std(axis=0, ddof=1)
        wide = np.where(sd > SCATTERS * v, sd, v)
        if np.mean(wide > v) > 0.02:
            model, mean = refitted(self.rig, model, self.data, wide, FITTING, rounds)
        after, wider = self.data - mean, np.log(wide / v)
        gained, confirmed = (
            gap(flat(self.rest, parts)) - gap(flat(after / wide, parts)) - float(flat(wider, parts).mean())
            for parts in (TRAINING, HELD_OUT)
        )
        honest = np.where(sd > SCATTERS * v, sd, spread.v)
        training, held_out = (gap(flat(after / honest, parts)) for parts in (TRAINING, HELD_OUT))
        return Trial(candidate, model, mean, gain, training, held_out, gained, confirmed)

    def anew(self, trial: Trial) -> Trial:
        """The trial, or the effect fitted from the size nearest to it and the base without it, if that is
        better: either may stop in a valley of its own."""
        if trial.training <= self.at_chance:
            return trial
        return max(trial, self.judged(trial.candidate, self._start(trial), trial.gain), key=_gained)

    def settled(self, best: Trial) -> Trial:
        """The trial fitted to the end: from where it is, anew, and from the camera file, as the base may have
        gone far astray for want of the effect."""
        starts = [best.model]
        if best.training > self.at_chance:
            starts += [self._start(best), self._nearest(self._from_file(best.candidate))]
        ends = self.rig.each(lambda one: self.judged(best.candidate, one, best.gain, rounds=3), starts)
        return max(ends, key=_gained)

    def _from_file(self, candidate: Candidate) -> list[Model]:
        """The effect at several sizes, base parameters as in the camera file."""
        sizes = [candidate.scaled(each, more) for each in candidate.sizes for more in (1, 2.5)]
        return [from_file(self.screen.model).with_effect(candidate, size) for size in sizes]

    def _nearest(self, starts: Sequence[Model]) -> Model:
        """That which leaves the least gap as it is."""
        means = self.rig.means([start.parameters() for start in starts], FITTING)
        z = [flat((self.data - mean) / self.screen.spread.lenient) for mean in means]
        return starts[int(np.argmin([gap(one) for one in z]))]

    def _start(self, trial: Trial) -> Model:
        one, found = trial.candidate, trial.model.sizes()[-1]
        alike = [size for size in one.sizes if size[0] * found[0] > 0]  # a fit does not change the sign
        nearest = min(alike, key=lambda size: abs(np.log(size[0] / found[0])))
        return self.screen.model.with_effect(one, nearest)


def _gained(trial: Trial) -> float:
    return trial.gained


def from_file(model: Model) -> Model:
    """The model with base parameters as in the camera file."""
    return replace(model, shift=(0.0,) * len(BASE) + model.shift[len(BASE) :])
