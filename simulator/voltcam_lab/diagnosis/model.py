"""A model with some effects in it, and how it is fitted to what the battery saw."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ..battery import FLOORS
from .catalogue import Candidate
from .lights import LIGHTS
from .rig import Rig, Values
from .robust import fitted, gap

BASE = (
    ("contrast_response", "k1"),
    ("contrast_response", "k2_dn"),
    ("photon_noise", "k3"),
    ("junction_leak", "k4_per_us"),
    ("parasitic_photocurrent", "k5_per_dn_us"),
    ("leak_noise", "k6"),
)
BASE_SD = 0.5  # of the logarithm of a base parameter about what the camera file says
SIZE_SD = 1.5  # of an effect's size about the one it was found with
STEP = 0.15  # of a logarithm, for derivatives by runs with common noise
FLOOR_SHARE = 0.003  # of a statistic: the rig is not better than that
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

    def parameters(self, shift: Sequence[float] | None = None) -> Parameters:
        """The parameters; limits of the registry hold."""
        shift = self.shift if shift is None else shift
        changes: dict[str, dict[str, float]] = {}
        for (effect, name), log in zip(BASE, shift, strict=False):
            value = getattr(getattr(self.start, effect), name)
            changes.setdefault(effect, {})[name] = float(value * np.exp(log))
        parameters = self.start.changed(changes)
        place = len(BASE)
        for candidate, size in self.accepted:
            logs = shift[place : place + len(size)]
            moved = tuple(one * float(np.exp(log)) for one, log in zip(size, logs, strict=True))
            parameters = candidate.on(parameters, within(candidate, moved))
            place += len(size)
        return parameters

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


def within(candidate: Candidate, size: tuple[float, ...]) -> tuple[float, ...]:
    """The size inside the registry's limits."""
    if candidate.names == ("ratio",):
        return size
    fields = type(getattr(Parameters(), candidate.effect)).model_fields
    kept = []
    for name, value in zip(candidate.names, size, strict=True):
        low, high = -np.inf, np.inf
        for limit in fields[name].metadata:
            low = max(low, getattr(limit, "ge", -np.inf), getattr(limit, "gt", -np.inf))
            high = min(high, getattr(limit, "le", np.inf))
        clipped = float(np.clip(value, low, high))
        kept.append(round(clipped) if fields[name].annotation is int else clipped)
    return tuple(kept)


@dataclass(frozen=True, eq=False)
class Spread:
    """Of the twins of a model: mean and the v of each statistic, both (PARTS, n), and the twins
    themselves."""

    mean: Values
    v: Values
    twins: list[Values]

    def against_others(self, n: int) -> Values:
        """Deviation of a twin from those that saw other versions of the light, in units of v."""
        others = [twin for k, twin in enumerate(self.twins) if (k - n) % len(LIGHTS)]
        return np.asarray((self.twins[n] - np.mean(others, axis=0)) / self.v)


def spread_of(rig: Rig, parameters: Parameters, seeds: Sequence[int]) -> Spread:
    """Twins of a model: one for each seed."""
    twins = list(rig.runs([parameters], seeds)[0])
    mean, sd = np.mean(twins, axis=0), np.std(twins, axis=0, ddof=1)
    v = np.sqrt(np.maximum(sd, FLOORS) ** 2 * (1 + 1 / len(seeds)) + (FLOOR_SHARE * mean) ** 2)
    return Spread(mean, v, twins)


def slopes(rig: Rig, model: Model, seeds: Sequence[int], v: Values) -> NDArray[np.float64]:
    """(PARTS, n, k): derivatives of what the battery sees with respect to the model's `shift`, in units of
    v."""
    k = len(model.shift)
    there = [model.parameters((model.shift + row).tolist()) for row in STEP * np.eye(k)]
    return np.stack([one / STEP / v for one in rig.changes(model.parameters(), there, seeds)], axis=-1)


def flat(values: NDArray[np.float64], parts: Sequence[int] = TRAINING) -> NDArray[np.float64]:
    """(PARTS, n, ...) as (parts n, ...)."""
    return values[list(parts)].reshape(-1, *values.shape[2:])


def refitted(
    rig: Rig, model: Model, data: Values, v: Values, seeds: Sequence[int], rounds: int = 1
) -> tuple[Model, Values]:
    """The model moved to where it is nearest to the data in the training parts, and what the battery sees of
    it on average. Gauss and Newton's method with common noise; slopes are taken anew in each round."""
    mean = rig.means([model.parameters()], seeds)[0]
    best = gap(flat((data - mean) / v))
    for _ in range(rounds):
        columns, at_first = flat(slopes(rig, model, seeds[:2], v)), best
        for _ in range(3):
            move = np.clip(fitted(flat((data - mean) / v), columns, model.prior_sd).x, -0.8, 0.8)
            for length in (1.0, 0.4, 0.1):
                moved = replace(model, shift=tuple((np.array(model.shift) + length * move).tolist()))
                moved_mean = rig.means([moved.parameters()], seeds)[0]
                left = gap(flat((data - moved_mean) / v))
                if left < best:
                    break
            else:
                break
            gained, model, mean, best = best - left, moved, moved_mean, left
            if gained < 0.005:
                break
        if at_first - best < 0.01:
            break
    return model, mean
