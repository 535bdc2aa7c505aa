"""Whether more is left than light between frames and the forms of effects leave, by both views of it.

Statistics of strips give an excess, in units of chance; all pixels give evidence in nats. Where nothing is
missing, light leaves something of either: an amount that is exponential about its mean. How large the light's
errors are is not known well, so what larger ones leave in nats is a part of that mean. Both views together
are Fisher's combination of the two probabilities (Statistical Methods for Research Workers, 1932).
"""

import math

import numpy as np
from scipy.stats import gamma

from ..rig.whole import Remains
from .settings import SearchSettings
from .settings_proof import Naming
from .step import SearchStep


def more_than_light(
    step: SearchStep, first: SearchStep, remains: Remains | None, settings: SearchSettings
) -> bool:
    """Whether a step leaves more than is left where nothing is missing, but for one such recording in twenty.

    first: the step before any effect was found. remains: by what all pixels tell, if they can tell anything.
    """
    return by_light(step, first, remains, settings.naming) <= settings.alarm


def by_light(step: SearchStep, first: SearchStep, remains: Remains | None, naming: Naming) -> float:
    """How often light, and forms of effects that were found, leave as much: 0 to 1.

    What forms leave for all pixels to tell nobody has measured: with effects, strips alone are asked.
    """
    share = max(step.excess, 0.0) / _mean(step, first, naming)
    if step is not first or remains is None:
        return float(np.exp(-share))
    nats = max(remains.evidence, 0.0) / (naming.light_nats + remains.by_larger_errors)
    return float(gamma.sf(share + nats, 2))


def most_left(step: SearchStep, first: SearchStep, settings: SearchSettings) -> float:
    """The excess that they leave in all but one of twenty such recordings."""
    return -_mean(step, first, settings.naming) * math.log(settings.alarm)


def _mean(step: SearchStep, first: SearchStep, naming: Naming) -> float:
    """Of the excess that light leaves, with the forms of effects where some were found."""
    return naming.light + naming.form * max(first.excess, 0.0) * (step is not first)
