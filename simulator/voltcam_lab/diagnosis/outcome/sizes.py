"""How large an effect is that was found, and how well that is known."""

import numpy as np

from ..catalogue.candidate import Candidate
from ..search.hypothesis import BASE
from ..search.loop import Diagnosis
from ..search.settings import DEFAULTS, SearchSettings
from .result import IntervalEstimate

Z_90 = 1.645
"""Half width of a 90 % interval of a normal distribution [standard deviations]: no choice, so no setting."""


def size_estimates(
    diagnosis: Diagnosis, candidate: Candidate, origin_us: int = 0, settings: SearchSettings = DEFAULTS
) -> dict[str, IntervalEstimate]:
    """Of an accepted effect's sizes, by its own parameters' names, on a clock whose zero the diagnosis has at
    -origin_us."""
    place, hypothesis = len(BASE), diagnosis.hypothesis
    sizes = next(
        place + sum(len(size) for _, size in hypothesis.accepted[:k]) + np.arange(len(candidate.names))
        for k, (one, _) in enumerate(hypothesis.accepted)
        if (one.effect, one.names) == (candidate.effect, candidate.names)
    )
    assert diagnosis.covariance is not None
    sd = np.sqrt(np.diag(diagnosis.covariance)[sizes] + settings.reporting.systematic_log_sd**2)
    half_widths = tuple(Z_90 * float(one) for one in sd)
    found = candidate.intervals(hypothesis.parameters(), half_widths, origin_us)
    return {
        name: IntervalEstimate(value=value, low=low, high=high) for name, (value, low, high) in found.items()
    }
