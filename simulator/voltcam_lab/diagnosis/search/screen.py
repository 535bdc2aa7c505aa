"""Which effect's signature is in the gap: a score test over the catalogue.

Base parameters and the light's errors are projected out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator import Parameters

from ...statistics import IN_ANY_LIGHT, Values
from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from .chance import Chance
from .hypothesis import Hypothesis
from .robust import RobustFit, robust_fit
from .settings import SearchSettings
from .spread import TRAINING, TwinSpread, flat

LIGHT = 2  # columns of what the light may be off by
_IN_ANY_LIGHT = np.tile(IN_ANY_LIGHT, len(TRAINING))  # of flat training parts
_VIEWS = 2  # of a recording: all statistics, and those of any light


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
    late, and that its errors are larger than told. chance: of gains by all statistics. chance_in_any_light:
    the same by those that light between frames has no part in.
    """

    hypothesis: Hypothesis
    spread: TwinSpread
    base: NDArray[np.float64]
    signatures: tuple[Signature, ...]
    settings: SearchSettings
    chance: Chance
    chance_in_any_light: Chance

    def own(self, z: NDArray[np.float64]) -> RobustFit:
        """The part of training deviations z that the hypothesis' own parameters and the light can take up."""
        return self._fitted(z, flat(self.base), self._prior_sd)

    def gains(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """(signatures,) by how much each lessens the loss of z, beyond what the hypothesis' own parameters
        can."""
        return self._gains(z, np.ones(len(z), np.bool_))

    def gains_in_any_light(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same of the statistics of any light alone."""
        return self._gains(z, _IN_ANY_LIGHT)

    def _gains(self, z: NDArray[np.float64], seen: NDArray[np.bool_]) -> NDArray[np.float64]:
        z, base = z[seen], flat(self.base)[seen]
        own, prior_sd = self._fitted(z, base, self._prior_sd).gain, self._prior_sd_with_effect
        columns = [np.column_stack([base, flat(one.column)[seen]]) for one in self.signatures]
        both = [self._fitted(z, each, prior_sd) for each in columns]
        return np.array([max(found.gain - own, 0.0) if found.x[-1] > 0 else 0.0 for found in both])

    def p_value(self, z: NDArray[np.float64]) -> float:
        """How often twins and light gain as much where nothing is missing, by either view of z."""
        by_all = self.chance.p_value(float(self.gains(z).max()))
        in_any_light = self.chance_in_any_light.p_value(float(self.gains_in_any_light(z).max()))
        return min(_VIEWS * min(by_all, in_any_light), 1.0)  # Bonferroni's bound

    def with_effect(self, z: NDArray[np.float64], one: Signature) -> RobustFit:
        """Amounts of the hypothesis' own parameters, of the light and, last, of an effect that fit z best."""
        columns = np.column_stack([flat(self.base), flat(one.column)])
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
    test, none = settings.score_test, np.empty(0)
    light_gain = test.guessed_light_gain if rig.light_is_guessed else test.light_gain
    chances = Chance(none, light_gain), Chance(none)
    screen = Screen(hypothesis, spread, base, signatures, settings, *chances)
    null = [flat(z * (spread.sd / spread.inflated_sd)) for z in spread.left_out]
    return replace(
        screen,
        chance=replace(screen.chance, null=np.array([screen.gains(z).max() for z in null])),
        chance_in_any_light=Chance(np.array([screen.gains_in_any_light(z).max() for z in null])),
    )


def later(parameters: Parameters, delay_us: float) -> Parameters:
    """The same camera, all its events so much later: what light that is a little early or late does."""
    return parameters.changed({"latency": {"delay_us": parameters.latency.delay_us + delay_us}})
