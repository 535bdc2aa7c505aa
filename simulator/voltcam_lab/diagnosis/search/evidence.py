"""The evidence that effects are there, against something without a name that they can only stand in for.

How well does a wrong explanation explain? The catalogue itself can tell. Each effect is left out once, and
its signature is made as large as the gap. What the best others leave of it is what stand-ins leave: a
distribution of shares of the gap. What the light between frames leaves, and a little for the forms of
effects, is there either way: an amount that is exponential about its mean. Effects that are there leave it
and no more, stand-ins their share of the rest besides.

What is left is more than its amount. Where effects are there, the score test finds no more in it than chance
lets one; of what a stand-in leaves it finds much. See `of_what_follows`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta

from .robust import mean_huber
from .screen import Screen, Signature
from .settings_proof import Naming
from .step import SearchStep

Z = NDArray[np.float64]
_LEAST_P_VALUE = 1e-300  # has a logarithm
_MIDDLES = (np.arange(200) + 0.5) / 200  # quantiles over which light's part is averaged


@dataclass(frozen=True)
class Evidence:
    """log_odds: natural logarithm of how much likelier what is left is if the effects are there than if they
    stand in: that it is so little, and how much the score test finds in it. wrong: how often stand-ins leave
    as little."""

    log_odds: float
    wrong: float

    def enough(self, naming: Naming) -> bool:
        """Whether the effects are named."""
        return self.log_odds > 0 and self.wrong <= naming.wrong


def evidence(begin: SearchStep, after: SearchStep, effects: int, first: SearchStep) -> Evidence:
    """For so many effects that bring the gap of one step down to that of another; first: the step before any
    was found, whose gap is largest."""
    naming = begin.screen.settings.naming
    shares = stand_ins(begin.screen, begin.excess, effects)
    found = weighed(begin.excess, max(after.excess, 0.0), max(first.excess, begin.excess), shares, naming)
    return replace(found, log_odds=found.log_odds + of_what_follows(after.p_value))


def of_what_follows(p_value: float) -> float:
    """ln(-e p ln p): by what a small p-value of the score test, with the effects in the model, lowers the
    log odds that they are there, at most; 0 from p = 1/e on.

    It is uniform where they are there and no more is. Else it has another law, xi p^(xi - 1) with a xi below
    1 that nobody knows: the one that is best for p is taken (T. Sellke, M. J. Bayarri, J. O. Berger, The
    American Statistician 55, 2001).
    """
    p_value = max(p_value, _LEAST_P_VALUE)
    return 0.0 if p_value >= np.exp(-1) else float(1 + np.log(p_value) + np.log(-np.log(p_value)))


def weighed(excess: float, left: float, largest: float, shares: Sequence[float], naming: Naming) -> Evidence:
    """For effects that leave so much of an excess, where stand-ins leave these shares.

    largest: the excess before any effect was found; the forms of all of them leave something of it.
    """
    mean, law = naming.light + naming.form * largest, _law(shares, naming)
    left = min(max(left, 1e-3 * excess), 0.999 * excess)  # at its ends a density may be nothing
    by_light = -np.expm1(-left / mean)  # the probability that light and forms leave no more
    rest = excess + mean * np.log1p(-by_light * _MIDDLES)
    share = (left - excess + rest) / rest
    stands_in = by_light * np.mean(beta.pdf(share, *law) / rest)
    as_little = by_light * np.mean(beta.cdf(share, *law)) / -np.expm1(-excess / mean)
    return Evidence(float(-left / mean - np.log(mean * stands_in)), float(as_little))


def _law(shares: Sequence[float], naming: Naming) -> tuple[float, float]:
    """The beta law of the shares that stand-ins leave, by moments; the usual ones count as some more."""
    known, (usual, spread), weight = np.array(shares), naming.usual_stand_in, naming.usual_weight
    centre = (known.sum() + weight * usual) / (known.size + weight)
    squares = ((known - centre) ** 2).sum() + weight * (spread**2 + (usual - centre) ** 2)
    size = centre * (1 - centre) * (known.size + weight) / squares - 1
    size = max(size, 1 / min(centre, 1 - centre))  # no more stand-ins near 0 or 1 than in between
    return centre * size, (1 - centre) * size


def stand_ins(screen: Screen, excess: float, effects: int) -> list[float]:
    """The shares that so many of the others leave of each effect's signature, made as large as a gap; of an
    effect with several the least."""
    least: dict[str, float] = {}
    for one in screen.signatures:
        name = one.candidate.effect
        z = _as_large(screen, screen.flat(one.column), excess)
        if z is not None:
            others = [other for other in screen.signatures if other.candidate.effect != name]
            least[name] = min(least.get(name, 1.0), _left(screen, z, others, effects) / excess)
    return list(least.values())


def _as_large(screen: Screen, column: Z, excess: float) -> Z | None:
    """The column times the amount at which own parameters leave so much of it; None where they take it up."""
    low, high = np.log(screen.settings.naming.amounts)
    if _rest(screen, np.exp(high) * column) < excess:
        return None
    while high - low > screen.settings.naming.amount_log_step:
        middle = (low + high) / 2
        low, high = (low, middle) if _rest(screen, np.exp(middle) * column) > excess else (middle, high)
    return np.asarray(np.exp(high) * column)


def _rest(screen: Screen, z: Z) -> float:
    """The gap that own parameters leave of z."""
    return mean_huber(z, screen.settings.huber_z) - screen.own(z).gain / z.size


def _left(screen: Screen, z: Z, others: Sequence[Signature], effects: int) -> float:
    """The gap that so many others leave of z, own parameters following, at each turn the best."""
    left = _rest(screen, z)
    for _ in range(effects):
        fits = [(screen.with_effect(z, other), other) for other in others]
        possible = [(fit, other) for fit, other in fits if fit.x[-1] > 0]
        if not possible:
            break
        fit, best = max(possible, key=lambda one: one[0].gain)
        left = min(left, mean_huber(z, screen.settings.huber_z) - fit.gain / z.size)
        z = z - fit.x[-1] * screen.flat(best.column)
    return left
