"""How often so much is gained where nothing is missing."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import norm

_NORMAL = np.linspace(-12, 12, 2401)  # an error of the light in its sd
_WEIGHTS = norm.pdf(_NORMAL) / norm.pdf(_NORMAL).sum()
_LEAST_SCALE = 1.0  # the largest of many halves of squared normal numbers has that one
_MOST_GAIN = 1e6  # more than any
RARE = 0.05
"""p-value from which on the second view of a recording says nothing. Convention: nine tenths of all p-values
are those of the first view, nearly."""
_SURE = -30.0  # deviations above which a gain is sure to be


def of_two_views(p_value: float, second: bool) -> float:
    """That of one view of two: the smaller one of both is uniform where nothing is missing.

    It is that of Šidák's correction (Journal of the American Statistical Association, 1967), but that the
    second view counts only where it is rare: of a few statistics chance makes lumps, not a law.
    """
    if second and p_value > RARE:
        return 1.0
    return 1.0 - (1.0 - p_value) * (1.0 - min(p_value, RARE))


@dataclass(frozen=True, eq=False)
class Chance:
    """null: (m,) gains where nothing is missing, each twin's largest over the catalogue. light_gain: mean of
    what the light adds to a recording's gain."""

    null: NDArray[np.float64]
    light_gain: float = 0.0

    def p_value(self, gain: float) -> float:
        """How often, where nothing is missing, something in the catalogue gains as much of what twins scatter
        by and what the light adds: an error of it goes either way, and its square is what it adds."""
        scale = max(float(np.std(self.null)) * np.sqrt(6) / np.pi, _LEAST_SCALE)
        loc = float(np.mean(self.null)) - np.euler_gamma * scale
        light = self.light_gain * _NORMAL**2
        beyond = np.maximum((gain - light - loc) / scale, _SURE)  # Gumbel's law: the largest of many
        return float(_WEIGHTS @ -np.expm1(-np.exp(-beyond)))

    def gain_of(self, p_value: float) -> float:
        """The gain with that p-value."""
        gain: Any = brentq(lambda gain: self.p_value(gain) - p_value, 0.0, _MOST_GAIN)
        return float(gain)
