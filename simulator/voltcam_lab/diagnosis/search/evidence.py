"""The evidence that effects are there, against something without a name that they can only stand in for.

Two things are seen of effects that were fitted: how much of the excess they leave, and the p-value of the
score test in what is left. Both have a law under each claim.

There, and nothing else is missing: the light between frames, and a little for the forms of effects, leave an
amount that is exponential about its mean. The p-value is uniform.

There, and something else is missing besides: that leaves an amount of its own, of any order up to the excess.

Standing in: a share of the excess is left besides what light leaves. Shares have the law that was measured
where the effect in the recording has no name, or was deleted from the catalogue.

What is missing still, in the latter two, is seen by the score test: the more of it, the less is the p-value.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta
from scipy.stats.qmc import Halton

from .settings_proof import Naming
from .step import SearchStep

Z = NDArray[np.float64]
_LEAST = 1e-300  # p-value: a power of it is no infinity
_ENDS = 1e-3, 0.75  # shares of an excess: no effect is tried that leaves more, and at 0 a density is nothing
_QUANTILES = (np.arange(200) + 0.5) / 200  # of light's part, over which densities are averaged
_STAND_INS = Halton(3, scramble=False).random(4001)[1:]  # quantiles of light's part, of a share, of a p-value


@dataclass(frozen=True)
class Evidence:
    """log_odds: natural logarithm of how much likelier what is seen is if the effects are there than if they
    stand in. wrong: how often stand-ins have such odds."""

    log_odds: float
    wrong: float

    def enough(self, naming: Naming) -> bool:
        """Whether the effects are named."""
        return self.log_odds > 0 and self.wrong <= naming.wrong


def evidence(begin: SearchStep, after: SearchStep, effects: int, first: SearchStep) -> Evidence:
    """For so many effects that bring the gap of one step down to that of another; first: the step before any
    was found, whose gap is largest."""
    settings, statistics = begin.screen.settings, begin.screen.flat(begin.rest).size
    naming, largest = settings.naming, max(first.excess, begin.excess)
    seen = min(begin.least, settings.score_test.least_gain) / statistics
    laws = Laws(begin.excess, naming.light + naming.form * largest, seen, effects, naming)
    return laws.evidence(after.excess, after.p_value)


@dataclass(frozen=True)
class Laws:
    """Of what so many effects leave of an excess. light: the mean of what light and forms leave. seen: the
    excess at which the score test begins to see what is missing."""

    excess: float
    light: float
    seen: float
    effects: int
    naming: Naming

    def evidence(self, left: float, p_value: float) -> Evidence:
        """Of an excess that is left, with the p-value of the score test in it."""
        (log_odds,) = self._log_odds(np.array([left]), np.array([p_value]))
        return Evidence(float(log_odds), float(np.mean(self._of_stand_ins >= log_odds)))

    @cached_property
    def _of_stand_ins(self) -> Z:
        """(n,) log odds of stand-ins, spread evenly over the laws of what they leave and of p-values."""
        light, share, p_value = _STAND_INS.T
        light = -self.light * np.log1p(light * np.expm1(-self.excess / self.light))
        missing = beta.ppf(share, *self._shares) * (self.excess - light)
        return self._log_odds(light + missing, p_value ** (1 / self._power(missing)))

    def _log_odds(self, left: Z, p_value: Z) -> Z:
        """(n,) of what is left and of p-values in it."""
        low, high = _ENDS
        left = np.clip(left, low * self.excess, high * self.excess)
        p_value = np.maximum(p_value, _LEAST)
        most = -np.expm1(-left / self.light)  # the probability that light and forms leave no more
        missing = left[:, None] + self.light * np.log1p(-most[:, None] * _QUANTILES)
        power = self._power(missing)
        found = power * np.exp((power - 1) * np.log(p_value)[:, None])  # density of the p-value
        rest = self.excess - left[:, None] + missing
        stand_in = most * np.mean(beta.pdf(missing / rest, *self._shares) / rest * found, axis=1)
        orders = (missing + self.seen) * np.log1p(self.excess / self.seen)
        besides = most * np.mean(found / orders, axis=1)
        alone = np.exp(-left / self.light) / self.light
        weight = self.naming.besides
        return np.asarray(np.log((1 - weight) * alone + weight * besides) - np.log(stand_in))

    def _power(self, missing: Z) -> Z:
        """The power xi of the law xi p^(xi - 1) of a p-value, where so much is missing still: 1 for nothing,
        which is uniform; -ln p has the mean 1 / xi."""
        least = self.naming.unseen
        return least + (1 - least) / (1 + missing / self.seen)

    @property
    def _shares(self) -> tuple[float, float]:
        """Of the Beta law of shares, by moments: each of several stand-ins leaves its share of the rest."""
        mean, sd = self.naming.stand_in
        centre, square = mean**self.effects, (mean**2 + sd**2) ** self.effects
        size = centre * (1 - centre) / (square - centre**2) - 1
        return centre * size, (1 - centre) * size
