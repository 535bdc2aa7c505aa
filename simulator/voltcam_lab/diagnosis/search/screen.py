"""Which effect's signature is in the gap: a score test over the catalogue.

Base parameters and the light's errors are projected out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...statistics import IN_ANY_LIGHT, Values
from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from .chance import Chance, of_two_views
from .hypothesis import Hypothesis
from .robust import RobustFit, robust_fit
from .settings import SearchSettings
from .spread import TRAINING, TwinSpread, flat

LIGHT = 2  # columns of what the light may be off by
VIEWS = 2  # of a recording: all statistics, and those of any light


@dataclass(frozen=True, eq=False)
class Signature:
    """What an effect at a size does to the statistics: column (PARTS, n) in units of the inflated sd."""

    candidate: Candidate
    size: tuple[float, ...]
    column: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Screen:
    """Signatures of the catalogue on a hypothesis, and how the same hypothesis' twins score on them.

    base: (PARTS, n, k + LIGHT) columns of the hypothesis' own parameters and, last, of the light: that it is
    late, and that its errors are larger than told. seen: (n,) the statistics that are looked at: all, or
    those that light between frames has no part in. light_gain: as of `Chance`.
    """

    hypothesis: Hypothesis
    spread: TwinSpread
    base: NDArray[np.float64]
    signatures: tuple[Signature, ...]
    settings: SearchSettings
    seen: NDArray[np.bool_]
    light_gain: float = 0.0

    @cached_property
    def in_any_light(self) -> "Screen":
        """The same by the statistics of any light alone."""
        return replace(self, seen=IN_ANY_LIGHT, light_gain=0.0)

    @cached_property
    def chance(self) -> Chance:
        """Of gains where nothing is missing: of each twin, left out of the others."""
        shrunk = self.spread.sd / self.spread.inflated_sd
        null = [self.gains(self.flat(z * shrunk)).max() for z in self.spread.left_out]
        return Chance(np.array(null), self.light_gain)

    def flat(self, values: NDArray[np.float64], parts: Sequence[int] = TRAINING) -> NDArray[np.float64]:
        """(PARTS, n, ...) as (parts seen, ...): a part's statistics that are seen."""
        return flat(values[:, self.seen], parts)

    def own(self, z: NDArray[np.float64]) -> RobustFit:
        """The part of training deviations z, `flat`, that the hypothesis' own parameters and the light can
        take up."""
        return self._fitted(z, self.flat(self.base), self._prior_sd)

    def gains(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """(signatures,) by how much each lessens the loss of z, beyond what the hypothesis' own parameters
        can."""
        own, both = self.own(z).gain, [self.with_effect(z, one) for one in self.signatures]
        return np.array([max(found.gain - own, 0.0) if found.x[-1] > 0 else 0.0 for found in both])

    def p_value(self, z: NDArray[np.float64]) -> float:
        """How often twins and light gain as much where nothing is missing, in this view or the other one."""
        return of_two_views(self.chance.p_value(float(self.gains(z).max())), second=not self.seen.all())

    def with_effect(self, z: NDArray[np.float64], one: Signature) -> RobustFit:
        """Amounts of the hypothesis' own parameters, of the light and, last, of an effect that fit z best."""
        columns = np.column_stack([self.flat(self.base), self.flat(one.column)])
        return self._fitted(z, columns, self._prior_sd_with_effect)

    @property
    def _prior_sd(self) -> Values:
        """(k + LIGHT,) of `base`: what the light does is in units of its sd."""
        return np.append(self.hypothesis.prior_sd(self.settings), np.ones(LIGHT))

    @property
    def _prior_sd_with_effect(self) -> Values:
        return np.append(self._prior_sd, self.settings.prior.amount_sd)

    def _fitted(self, z: Values, columns: Values, prior_sd: Values) -> RobustFit:
        return robust_fit(z, columns, prior_sd, self.settings.huber_z, self.settings.fit.reweightings)


def screen_of(
    rig: Rig,
    hypothesis: Hypothesis,
    spread: TwinSpread,
    candidates: Sequence[Candidate],
    settings: SearchSettings,
) -> Screen:
    """Signatures by runs with common noise; the null by the twins of `spread`, each left out of it."""
    parameters = hypothesis.parameters()
    plan = [(candidate, size) for candidate in candidates for size in candidate.sizes]
    there = [candidate.on(parameters, size) for candidate, size in plan]
    there.append(later(parameters, settings.model_error.light_delay_us))
    *changes, delayed = rig.changes(parameters, there, settings.runs.signatures)
    signatures = tuple(
        Signature(candidate, size, change / spread.inflated_sd)
        for (candidate, size), change in zip(plan, changes, strict=True)
    )
    light = np.stack([delayed, spread.light], axis=-1) / spread.inflated_sd[..., None]
    base = np.concatenate([spread.columns, light], axis=-1)
    test = settings.score_test
    light_gain = test.guessed_light_gain if rig.light_is_guessed else test.light_gain
    return Screen(hypothesis, spread, base, signatures, settings, np.ones_like(IN_ANY_LIGHT), light_gain)


def later(parameters: Parameters, delay_us: float) -> Parameters:
    """The same camera, all its events so much later: what light that is a little early or late does."""
    return parameters.changed({"latency": {"delay_us": parameters.latency.delay_us + delay_us}})
