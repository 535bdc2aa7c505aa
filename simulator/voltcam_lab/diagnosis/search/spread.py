"""Twins of a hypothesis: what they give on average, how they scatter, how that changes with parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...statistics import FLOORS, Values
from ..rig.rig import Rig
from .hypothesis import BASE, Hypothesis
from .settings import SearchSettings

Slopes = NDArray[np.float64]
"""(PARTS, n, k): of each statistic with respect to each entry of a hypothesis' `shift`."""
TRAINING, HELD_OUT = (0, 1, 2), (3,)
"""Parts of a recording that fits see, and that they do not."""


@dataclass(frozen=True, eq=False)
class TwinSpread:
    """Twins of a hypothesis: mean and sd of each statistic, both (PARTS, n), the twins themselves, and
    (PARTS, n, k) slopes of the mean with respect to the hypothesis' `shift`.

    sd: of twins and `model_variance`, the square of what a model and its light are off by. inflated_sd: sd
    and a share of what the effects in the model do; more effects are looked for in its units. versions: of
    the light, seen by one twin after the other. light: (PARTS, n) change of the mean, see `noisier_light`.
    """

    mean: Values
    sd: Values
    model_variance: Values
    inflated_sd: Values
    twins: list[Values]
    slopes: Slopes
    versions: int
    light: Values

    @property
    def columns(self) -> NDArray[np.float64]:
        """The slopes in units of `inflated_sd`."""
        return self.slopes / self.inflated_sd[..., None]

    @cached_property
    def left_out(self) -> list[Values]:
        """(twins) z of each twin against those that saw other versions of the light, in units of the sd that
        these alone give: what a recording is to its twins where nothing is missing."""
        found = []
        for n, twin in enumerate(self.twins):
            mean, variance = _mean_and_variance(
                [other for k, other in enumerate(self.twins) if (k - n) % self.versions]
            )
            found.append((twin - mean) / np.sqrt(variance + self.model_variance))
        return found


def spread_of(rig: Rig, hypothesis: Hypothesis, seeds: Sequence[int], settings: SearchSettings) -> TwinSpread:
    """Twins of a hypothesis: one for each seed."""
    twins = list(rig.runs([hypothesis.parameters()], seeds)[0])
    mean, variance = _mean_and_variance(twins)
    slopes = slopes_of(rig, hypothesis, settings.runs.slopes, settings)
    base, effects = np.split(slopes, [len(BASE)], axis=-1)
    error = settings.model_error
    of_base = error.base_share**2 * (base**2).sum(axis=-1)
    light = noisier_light(rig, hypothesis, settings)
    model_variance = (error.statistic_share * mean) ** 2 + of_base + light**2
    of_effects = error.effect_share**2 * (effects**2).sum(axis=-1)
    inflated_sd = np.sqrt(variance + model_variance + of_effects)
    sd = np.sqrt(variance + model_variance)
    return TwinSpread(mean, sd, model_variance, inflated_sd, twins, slopes, rig.versions, light)


def noisier_light(rig: Rig, hypothesis: Hypothesis, settings: SearchSettings) -> Values:
    """(PARTS, n) change of the mean where the light's errors are `RigSettings.noisier` times what is told.

    Errors of the light are known no better. Nor is how they spread over the statistics: so each may be off by
    as much, by itself.
    """
    parameters, seeds = [hypothesis.parameters()], settings.runs.fitting
    told, noisier = (rig.means(parameters, seeds, noisier=more)[0] for more in (False, True))
    return noisier - told


def _mean_and_variance(twins: list[Values]) -> tuple[Values, Values]:
    """Their mean, and the variance of one more about it."""
    sd = np.maximum(np.std(twins, axis=0, ddof=1), FLOORS)
    return np.mean(twins, axis=0), sd**2 * (1 + 1 / len(twins))


def slopes_of(
    rig: Rig, hypothesis: Hypothesis, seeds: Sequence[int], settings: SearchSettings, first: int = 0
) -> Slopes:
    """The slopes at a hypothesis, of the entries of its `shift` from `first` on.

    By runs on both sides: statistics bend so much that a step to one side is off.
    """
    derivatives = settings.derivatives
    steps = np.full(len(hypothesis.shift), derivatives.wide_step)
    steps[: len(BASE)] = [
        derivatives.step if name in derivatives.sharp else derivatives.wide_step for _, name in BASE
    ]
    moves, steps = np.diag(steps / 2)[first:], steps[first:]
    k = len(moves)
    there = [hypothesis.parameters((hypothesis.shift + move).tolist()) for move in (*moves, *-moves)]
    means = rig.means(there, seeds)
    change = np.stack([up - down for up, down in zip(means[:k], means[k:], strict=True)], axis=-1)
    return np.asarray(change / steps)


def flat(values: NDArray[np.float64], parts: Sequence[int] = TRAINING) -> NDArray[np.float64]:
    """(PARTS, n, ...) as (parts n, ...)."""
    return values[list(parts)].reshape(-1, *values.shape[2:])
