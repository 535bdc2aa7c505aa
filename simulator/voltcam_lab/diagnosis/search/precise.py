"""The parameters of a model that is fitted already, from all twins at once, and how certain they are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...statistics import Values
from ..rig.rig import Rig
from .hypothesis import Hypothesis
from .robust import huber_weight, robust_fit
from .settings import SearchSettings
from .spread import TwinSpread, flat, slopes_of


@dataclass(frozen=True, eq=False)
class Precise:
    """covariance: (k, k) of the hypothesis' `shift`, at most the prior's."""

    hypothesis: Hypothesis
    covariance: NDArray[np.float64]


def precise(
    rig: Rig,
    hypothesis: Hypothesis,
    spread: TwinSpread,
    settings: SearchSettings,
    data: Values | None = None,
) -> Precise:
    """The hypothesis moved to the least loss on straight lines through its twins (not at all without data).

    Fits compare means of four runs, whose noise hides what is less than some standard deviations; the mean of
    all twins and slopes of more seeds tell more. Statistics are not independent of each other, so the
    covariance is H^-1 (J + R) H^-1, H = C'C + R, R the prior, J the covariance of the score C'z over twins.
    """
    slopes = slopes_of(rig, hypothesis, settings.runs.precise_slopes, settings)
    columns, prior_sd = flat(slopes / spread.inflated_sd[..., None]), hypothesis.prior_sd(settings)
    z = np.zeros(len(columns)) if data is None else flat((data - spread.mean) / spread.inflated_sd)
    fit = settings.fit
    found = robust_fit(
        z, columns, prior_sd, settings.huber_z, fit.precise_rounds, fit.precise_longest_step,
        first_weight=np.ones(len(z)),
    )  # fmt: skip
    weight, prior = huber_weight(found.rest, settings.huber_z), np.diag(prior_sd**-2.0)
    inverse = np.linalg.inv(columns.T @ (columns * weight[:, None]) + prior)
    scores = [columns.T @ (weight * flat((twin - spread.mean) / spread.inflated_sd)) for twin in spread.twins]
    scattered = np.cov(np.transpose(scores)) * (1 + 1 / len(spread.twins))
    covariance = inverse @ (scattered + prior) @ inverse
    within = np.minimum(prior_sd / np.sqrt(np.diag(covariance)), 1.0)
    return Precise(hypothesis.moved(found.x), np.asarray(covariance * np.outer(within, within)))
