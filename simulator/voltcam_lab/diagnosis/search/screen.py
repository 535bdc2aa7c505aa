"""Which effect's signature is in the gap: a score test over the catalogue, base parameters projected out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, gumbel_r

from ..catalogue.candidate import Candidate
from ..rig.rig import Rig
from .model import Model, Spread, flat
from .robust import Fitted, fitted

AMOUNT_SD = 1.0  # of an effect's amount about 0, in units of the size tried
OPEN_GAIN = 6.0  # of training loss: what light that frames leave open adds to a recording's, not to twins'
OPEN_GAINS = OPEN_GAIN * chi2.ppf((np.arange(28) + 0.5) / 28, 1)
"""Quantiles of its distribution: an error goes either way, and its square is what it adds."""


@dataclass(frozen=True, eq=False)
class Signature:
    """What an effect at a size does to the battery: column (PARTS, n) in units of the lenient spread."""

    candidate: Candidate
    size: tuple[float, ...]
    column: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Screen:
    """Signatures of the catalogue on a model, and how the same model's twins score on them."""

    model: Model
    spread: Spread
    base: NDArray[np.float64]  # (PARTS, n, k) of the model's own parameters
    signatures: tuple[Signature, ...]
    null: NDArray[np.float64]  # (n,) each twin's largest gain over the catalogue and each of OPEN_GAINS

    def own(self, z: NDArray[np.float64]) -> Fitted:
        """The part of training deviations z that the model's own parameters can take up."""
        return fitted(z, flat(self.base), self.model.prior_sd)

    def gains(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """(signatures,) by how much each lessens the loss of z, beyond what the model's own parameters
        can."""
        own, both = self.own(z).gain, [self.with_effect(z, one) for one in self.signatures]
        return np.array([max(found.gain - own, 0.0) if found.x[-1] > 0 else 0.0 for found in both])

    def with_effect(self, z: NDArray[np.float64], one: Signature) -> Fitted:
        """Amounts of the model's own parameters and, last, of an effect that fit z best."""
        columns = np.column_stack([flat(self.base), flat(one.column)])
        return fitted(z, columns, np.append(self.model.prior_sd, AMOUNT_SD))

    def p_value(self, gain: float) -> float:
        """How often twins, where nothing is missing, have as large a gain from anything in the catalogue."""
        rank = (1 + np.count_nonzero(self.null >= gain)) / (1 + self.null.size)
        if rank > 2 / (1 + len(self.spread.twins)):  # so far do these tell
            return float(rank)
        return float(min(rank, gumbel_r.sf(gain, *gumbel_r.fit(self.null))))


def screen_of(
    rig: Rig, model: Model, spread: Spread, candidates: Sequence[Candidate], seeds: Sequence[int]
) -> Screen:
    """Signatures by runs with common noise; the null by the twins of `spread`, each left out of it."""
    parameters = model.parameters()
    plan = [(candidate, size) for candidate in candidates for size in candidate.sizes]
    changes = rig.changes(parameters, [candidate.on(parameters, size) for candidate, size in plan], seeds)
    signatures = tuple(
        Signature(candidate, size, change / spread.lenient)
        for (candidate, size), change in zip(plan, changes, strict=True)
    )
    screen = Screen(model, spread, spread.columns, signatures, np.empty(0))
    lenience = spread.v / spread.lenient
    null = [screen.gains(flat(z * lenience)).max() for z in spread.left_out]
    return replace(screen, null=np.add.outer(null, OPEN_GAINS).ravel())
