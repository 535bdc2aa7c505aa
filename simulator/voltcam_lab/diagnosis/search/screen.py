"""Which effect's signature is in the gap: a score test over the catalogue.

Base parameters and the light's delay are projected out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, gumbel_r

from voltcam_simulator import Parameters

from ...statistics import Values
from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from .hypothesis import Hypothesis
from .robust import RobustFit, robust_fit
from .settings import SearchSettings
from .settings_proof import ScoreTest
from .spread import TwinSpread, flat


@dataclass(frozen=True, eq=False)
class Signature:
    """What an effect at a size does to the statistics: column (PARTS, n) in units of the inflated sd."""

    candidate: Candidate
    size: tuple[float, ...]
    column: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Screen:
    """Signatures of the catalogue on a hypothesis, and how the same hypothesis' twins score on them.

    base: (PARTS, n, k + 1) columns of the hypothesis' own parameters and, last, of `light_delay`. null: (m,)
    gains where nothing is missing, each twin's largest over the catalogue with each of `light_gains`.
    """

    hypothesis: Hypothesis
    spread: TwinSpread
    base: NDArray[np.float64]
    signatures: tuple[Signature, ...]
    null: NDArray[np.float64]
    settings: SearchSettings

    def own(self, z: NDArray[np.float64]) -> RobustFit:
        """The part of training deviations z that the hypothesis' own parameters and the light's delay can
        take up."""
        return self._fitted(z, flat(self.base), self._prior_sd)

    def gains(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """(signatures,) by how much each lessens the loss of z, beyond what the hypothesis' own parameters
        can."""
        own, both = self.own(z).gain, [self.with_effect(z, one) for one in self.signatures]
        return np.array([max(found.gain - own, 0.0) if found.x[-1] > 0 else 0.0 for found in both])

    def with_effect(self, z: NDArray[np.float64], one: Signature) -> RobustFit:
        """Amounts of the hypothesis' own parameters, of the light's delay and, last, of an effect that fit z
        best."""
        columns = np.column_stack([flat(self.base), flat(one.column)])
        return self._fitted(z, columns, np.append(self._prior_sd, self.settings.prior.amount_sd))

    @property
    def _prior_sd(self) -> Values:
        """(k + 1,) of `base`: the light's delay is in units of its sd."""
        return np.append(self.hypothesis.prior_sd(self.settings), 1.0)

    def _fitted(self, z: Values, columns: Values, prior_sd: Values) -> RobustFit:
        return robust_fit(z, columns, prior_sd, self.settings.huber_z, self.settings.fit.reweightings)

    def p_value(self, gain: float) -> float:
        """How often twins, where nothing is missing, have as large a gain from anything in the catalogue."""
        rank = (1 + np.count_nonzero(self.null >= gain)) / (1 + self.null.size)
        if rank > 2 / (1 + len(self.spread.twins)):  # so far do these tell
            return float(rank)
        return float(min(rank, gumbel_r.sf(gain, *gumbel_r.fit(self.null))))


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
    base = np.concatenate([spread.columns, (delayed / spread.inflated_sd)[..., None]], axis=-1)
    screen = Screen(hypothesis, spread, base, signatures, np.empty(0), settings)
    ratio = spread.sd / spread.inflated_sd
    null = [screen.gains(flat(z * ratio)).max() for z in spread.left_out]
    return replace(screen, null=np.add.outer(null, light_gains(settings.score_test)).ravel())


def later(parameters: Parameters, delay_us: float) -> Parameters:
    """The same camera, all its events so much later: what light that is a little early or late does."""
    return parameters.changed({"latency": {"delay_us": parameters.latency.delay_us + delay_us}})


def light_gains(test: ScoreTest) -> NDArray[np.float64]:
    """Quantiles of the training loss by which the light between frames adds to a recording's gain: an error
    goes either way, and its square is what it adds."""
    n = test.light_quantiles
    return np.asarray(test.light_gain * chi2.ppf((np.arange(n) + 0.5) / n, 1))
