"""Which effect's signature is in the gap: a score test over the catalogue.

Base parameters and the light's errors are projected out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import norm

from voltcam_simulator import Parameters

from ...statistics import Values
from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from .hypothesis import Hypothesis
from .robust import RobustFit, robust_fit
from .settings import SearchSettings
from .settings_proof import ScoreTest
from .spread import TwinSpread, flat

LIGHT = 2  # columns of what the light may be off by
_NORMAL = np.linspace(-12, 12, 2401)  # an error of the light in its sd
_WEIGHTS = norm.pdf(_NORMAL) / norm.pdf(_NORMAL).sum()
_LEAST_SCALE, _MOST_GAIN = 0.1, 1e6  # of gains: where twins have none, and more than any
_SURE = -30.0  # deviations above which a gain is sure to be


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
    late, and that its errors are larger than told. null: (m,)
    gains where nothing is missing, each twin's largest over the catalogue. light_gain: mean of what the light
    adds to a recording's gain.
    """

    hypothesis: Hypothesis
    spread: TwinSpread
    base: NDArray[np.float64]
    signatures: tuple[Signature, ...]
    null: NDArray[np.float64]
    settings: SearchSettings
    light_gain: float = ScoreTest.light_gain

    def own(self, z: NDArray[np.float64]) -> RobustFit:
        """The part of training deviations z that the hypothesis' own parameters and the light can take up."""
        return self._fitted(z, flat(self.base), self._prior_sd)

    def gains(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """(signatures,) by how much each lessens the loss of z, beyond what the hypothesis' own parameters
        can."""
        own, both = self.own(z).gain, [self.with_effect(z, one) for one in self.signatures]
        return np.array([max(found.gain - own, 0.0) if found.x[-1] > 0 else 0.0 for found in both])

    def with_effect(self, z: NDArray[np.float64], one: Signature) -> RobustFit:
        """Amounts of the hypothesis' own parameters, of the light and, last, of an effect that fit z best."""
        columns = np.column_stack([flat(self.base), flat(one.column)])
        return self._fitted(z, columns, np.append(self._prior_sd, self.settings.prior.amount_sd))

    @property
    def _prior_sd(self) -> Values:
        """(k + LIGHT,) of `base`: what the light does is in units of its sd."""
        return np.append(self.hypothesis.prior_sd(self.settings), np.ones(LIGHT))

    def _fitted(self, z: Values, columns: Values, prior_sd: Values) -> RobustFit:
        return robust_fit(z, columns, prior_sd, self.settings.huber_z, self.settings.fit.reweightings)

    def p_value(self, gain: float) -> float:
        """How often, where nothing is missing, something in the catalogue gains as much of what twins scatter
        by and what the light adds: an error of it goes either way, and its square is what it adds."""
        scale = max(float(np.std(self.null)) * np.sqrt(6) / np.pi, _LEAST_SCALE)
        loc = float(np.mean(self.null)) - np.euler_gamma * scale
        light = self.light_gain * _NORMAL**2
        beyond = np.maximum((gain - light - loc) / scale, _SURE)  # Gumbel's law: the largest of many
        return float(_WEIGHTS @ -np.expm1(-np.exp(-beyond)))

    @cached_property
    def gain_of_chance(self) -> float:
        """The gain whose p-value is the chance of a name where nothing is missing."""
        alpha = self.settings.score_test.alpha
        gain: Any = brentq(lambda gain: self.p_value(gain) - alpha, 0.0, _MOST_GAIN)
        return float(gain)


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
    told, noisier = (
        rig.means([parameters], settings.runs.fitting, noisier=noisier)[0] for noisier in (False, True)
    )
    light = np.stack([delayed, noisier - told], axis=-1) / spread.inflated_sd[..., None]
    base = np.concatenate([spread.columns, light], axis=-1)
    test = settings.score_test
    light_gain = test.guessed_light_gain if rig.light_is_guessed else test.light_gain
    screen = Screen(hypothesis, spread, base, signatures, np.empty(0), settings, light_gain)
    ratio = spread.sd / spread.inflated_sd
    null = [screen.gains(flat(z * ratio)).max() for z in spread.left_out]
    return replace(screen, null=np.array(null))


def later(parameters: Parameters, delay_us: float) -> Parameters:
    """The same camera, all its events so much later: what light that is a little early or late does."""
    return parameters.changed({"latency": {"delay_us": parameters.latency.delay_us + delay_us}})
