"""What a camera may be: a camera file with effects added and parameters changed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...models.exact import K1_TO_K6
from ..catalogue.candidate import Candidate, within_limits
from .settings import DEFAULTS, SearchSettings

BASE = tuple(K1_TO_K6.values())
"""The base parameters: (effect, name) of each, the order of a hypothesis' `shift`."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """start: the camera file's parameters; accepted: effects added, each with the size at which its fit
    began; shift: (6 + sizes,) logarithms of the change of base parameters and of these sizes; smallest_base:
    `Priors.smallest_base`."""

    start: Parameters
    accepted: tuple[tuple[Candidate, tuple[float, ...]], ...] = ()
    shift: tuple[float, ...] = (0.0,) * len(BASE)
    smallest_base: Mapping[str, float] = field(default_factory=lambda: DEFAULTS.prior.smallest_base)

    def prior_sd(self, settings: SearchSettings) -> NDArray[np.float64]:
        """(k,) of `shift`."""
        prior = settings.prior
        sizes = len(self.shift) - len(BASE)
        return np.array([prior.base_log_sd] * len(BASE) + [prior.size_log_sd] * sizes)

    def far_from_file(self, settings: SearchSettings) -> dict[str, float]:
        """How many times what the camera file says, of base parameters that show sharply and are so far off
        that the file seems to be of another camera."""
        return {
            name: float(np.exp(log))
            for (effect, name), log in zip(BASE, self.shift, strict=False)
            if name in settings.derivatives.sharp
            and abs(log) > settings.prior.other_camera_log
            and getattr(getattr(self.start, effect), name) >= self.smallest_base.get(name, 0.0)
        }

    def off_prior(self, settings: SearchSettings) -> bool:
        """Base parameters far from the file and no effect added: the file is of another camera, or they stand
        in for an effect that is missing."""
        return bool(self.far_from_file(settings)) and not self.accepted

    def parameters(self, shift: Sequence[float] | None = None) -> Parameters:
        """The parameters; limits of the registry hold."""
        shift = self.shift if shift is None else shift
        changes: dict[str, dict[str, float]] = {}
        for (effect, name), log in zip(BASE, shift, strict=False):
            value = max(getattr(getattr(self.start, effect), name), self.smallest_base.get(name, 0.0))
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

    def moved(self, move: NDArray[np.float64] | float) -> "Hypothesis":
        """The same with `move` (k,) added to its shift."""
        return replace(self, shift=tuple((np.array(self.shift) + move).tolist()))

    def with_base_of_file(self) -> "Hypothesis":
        """The same with base parameters as in the camera file."""
        return replace(self, shift=(0.0,) * len(BASE) + self.shift[len(BASE) :])

    def with_effect(self, candidate: Candidate, size: tuple[float, ...]) -> "Hypothesis":
        """The same and one effect more."""
        return replace(
            self, accepted=(*self.accepted, (candidate, size)), shift=(*self.shift, *[0.0] * len(size))
        )

    def without(self, index: int) -> "Hypothesis":
        """The same without the accepted effect of this index."""
        place = len(BASE) + sum(len(size) for _, size in self.accepted[:index])
        length = len(self.accepted[index][1])
        return replace(
            self,
            accepted=self.accepted[:index] + self.accepted[index + 1 :],
            shift=self.shift[:place] + self.shift[place + length :],
        )


def start_of(parameters: Parameters, settings: SearchSettings) -> Hypothesis:
    """A camera file's parameters, where a search begins."""
    return Hypothesis(parameters, smallest_base=settings.prior.smallest_base)
