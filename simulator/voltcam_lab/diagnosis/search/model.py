"""A model with some effects in it, and how it is fitted to what the battery saw."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...models.exact import K1_TO_K6
from ...statistics import FLOORS
from ..catalogue.candidate import Candidate, within_limits
from ..rig.lights import LIGHTS
from ..rig.rig import Rig, Values

BASE = tuple(K1_TO_K6.values())
LEAST = {"k3": 1e-6, "k4_per_us": 5e-10, "k5_per_dn_us": 1e-12, "k6": 5e-7}
"""Too little to show in a recording of seconds. A camera file may have less, or nothing: of that, no share
more would be anything."""
BASE_SD = 0.5  # of the logarithm of a base parameter about where a fit begins, at first the camera file
SIZE_SD = 1.5  # of an effect's size about the same
STEP, WIDE_STEP = 0.15, 0.5  # of a logarithm, half to each side, for derivatives by runs with common noise
SHARP = ("k1", "k2_dn", "k5_per_dn_us")
"""What these do bends within a STEP; what others do, and effects, is lost in its noise."""
ANOTHER_CAMERA = 0.8  # of a logarithm: twice what cameras of a make are taken to differ by, 30 %
FLOOR_SHARE = 0.003  # of a statistic: the rig is not better than that
EFFECT_SHARE = 0.1  # of what an effect in the model does: a real one has another form
BASE_SHARE = 0.01  # of a base parameter: intervals at rest tell of leaks to a thousandth and drown all else
SLOPES = range(2)  # seeds of the runs that derivatives are taken of
TRAINING, HELD_OUT = (0, 1, 2), (3,)


@dataclass(frozen=True, eq=False)
class Model:
    """start: the camera file's parameters; shift: (6 + sizes,) logarithms of the change of base parameters
    and of the sizes of the accepted effects."""

    start: Parameters
    accepted: tuple[tuple[Candidate, tuple[float, ...]], ...] = ()
    shift: tuple[float, ...] = (0.0,) * len(BASE)

    @property
    def prior_sd(self) -> NDArray[np.float64]:
        """(k,) of `shift`."""
        return np.array([BASE_SD] * len(BASE) + [SIZE_SD] * (len(self.shift) - len(BASE)))

    @property
    def far_off(self) -> dict[str, float]:
        """How many times what the camera file says, of base parameters that show sharply and are so far off
        that the file seems to be of another camera."""
        return {
            name: float(np.exp(log))
            for (_, name), log in zip(BASE, self.shift, strict=False)
            if name in SHARP and abs(log) > ANOTHER_CAMERA and self._has(name)
        }

    def _has(self, name: str) -> bool:
        """Whether the camera file has enough of a base parameter for a share more to be anything."""
        effect = next(effect for effect, one in BASE if one == name)
        return bool(getattr(getattr(self.start, effect), name) >= LEAST.get(name, 0.0))

    @property
    def astray(self) -> bool:
        """Base parameters far off, with no effect in the model: of another camera, or for want of one."""
        return bool(self.far_off) and not self.accepted

    def parameters(self, shift: Sequence[float] | None = None) -> Parameters:
        """The parameters; limits of the registry hold."""
        shift = self.shift if shift is None else shift
        changes: dict[str, dict[str, float]] = {}
        for (effect, name), log in zip(BASE, shift, strict=False):
            value = max(getattr(getattr(self.start, effect), name), LEAST.get(name, 0.0))
            changes.setdefault(effect, {})[name] = float(value * np.exp(log))
        parameters = within_limits(self.start, changes)
        moved = replace(self, shift=tuple(shift))
        for (candidate, _), size in zip(self.accepted, moved.sizes(), strict=True):
            parameters = candidate.on(parameters, size)
        return parameters

    def sizes(self) -> list[tuple[float, ...]]:
        """Of the accepted effects, as fitted."""
        found, place = [], len(BASE)
        for _, size in self.accepted:
            logs = self.shift[place : place + len(size)]
            found.append(tuple(one * float(np.exp(log)) for one, log in zip(size, logs, strict=True)))
            place += len(size)
        return found

    def with_effect(self, candidate: Candidate, size: tuple[float, ...]) -> "Model":
        """The same and one effect more."""
        return replace(
            self, accepted=(*self.accepted, (candidate, size)), shift=(*self.shift, *[0.0] * len(size))
        )

    def without(self, index: int) -> "Model":
        """The same without the accepted effect of this index."""
        place = len(BASE) + sum(len(size) for _, size in self.accepted[:index])
        length = len(self.accepted[index][1])
        return replace(
            self,
            accepted=self.accepted[:index] + self.accepted[index + 1 :],
            shift=self.shift[:place] + self.shift[place + length :],
        )


@dataclass(frozen=True, eq=False)
class Spread:
    """Of the twins of a model: mean and the v of each statistic, both (PARTS, n), the twins themselves, and
    (PARTS, n, k) slopes of the mean with respect to the model's `shift`.

    v2 is the twins' variance and `doubt2`, what a model is off by. lenient: v and EFFECT_SHARE of what the
    effects in the model do, in which more effects are looked for.
    """

    mean: Values
    v: Values
    doubt2: Values
    lenient: Values
    twins: list[Values]
    slopes: NDArray[np.float64]

    @property
    def columns(self) -> NDArray[np.float64]:
        """The slopes in units of `lenient`."""
        return self.slopes / self.lenient[..., None]

    @cached_property
    def left_out(self) -> list[Values]:
        """Of each twin, the deviation from those that saw other versions of the light, in units of the v that
        these alone give: what a recording in which nothing is missing is like to twins that are not it."""
        found = []
        for n, twin in enumerate(self.twins):
            mean, chance2 = _chance([other for k, other in enumerate(self.twins) if (k - n) % len(LIGHTS)])
            found.append((twin - mean) / np.sqrt(chance2 + self.doubt2))
        return found


def spread_of(rig: Rig, model: Model, seeds: Sequence[int]) -> Spread:
    """Twins of a model: one for each seed."""
    twins = list(rig.runs([model.parameters()], seeds)[0])
    mean, chance2 = _chance(twins)
    sloping = slopes(rig, model)
    base, effects = np.split(sloping, [len(BASE)], axis=-1)
    of_base = BASE_SHARE**2 * (base**2).sum(axis=-1)
    doubt2 = (FLOOR_SHARE * mean) ** 2 + of_base
    lenient = np.sqrt(chance2 + doubt2 + EFFECT_SHARE**2 * (effects**2).sum(axis=-1))
    return Spread(mean, np.sqrt(chance2 + doubt2), doubt2, lenient, twins, sloping)


def _chance(twins: list[Values]) -> tuple[Values, Values]:
    """Their mean, and the variance of one more about it."""
    sd = np.maximum(np.std(twins, axis=0, ddof=1), FLOORS)
    return np.mean(twins, axis=0), sd**2 * (1 + 1 / len(twins))


def slopes(rig: Rig, model: Model, seeds: Sequence[int] = SLOPES) -> NDArray[np.float64]:
    """(PARTS, n, k): derivatives of what the battery sees with respect to the model's `shift`.

    By runs on both sides: with a sure parameter, a step to one side lands where lines have long bent.
    """
    k = len(model.shift)
    steps = np.full(k, WIDE_STEP)
    steps[: len(BASE)] = [STEP if name in SHARP else WIDE_STEP for _, name in BASE]
    moves = np.diag(steps / 2)
    there = [model.parameters((model.shift + move).tolist()) for move in (*moves, *-moves)]
    means = rig.means(there, seeds)
    change = np.stack([up - down for up, down in zip(means[:k], means[k:], strict=True)], axis=-1)
    return np.asarray(change / steps)


def flat(values: NDArray[np.float64], parts: Sequence[int] = TRAINING) -> NDArray[np.float64]:
    """(PARTS, n, ...) as (parts n, ...)."""
    return values[list(parts)].reshape(-1, *values.shape[2:])
