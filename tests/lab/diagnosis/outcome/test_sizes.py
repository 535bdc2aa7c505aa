"""How large a found effect is said to be."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.diagnosis.outcome.sizes import Z_90, size_estimates
from voltcam_lab.diagnosis.search.hypothesis import BASE, Hypothesis
from voltcam_lab.diagnosis.search.loop import Diagnosis
from voltcam_lab.diagnosis.search.settings import DEFAULTS

from ..made_rig import DEAD_TIME, MISMATCH, START
from ..made_steps import step


def test_sizes_have_intervals_of_their_own_covariance() -> None:
    """Of two effects the second; the spread of forms adds to it. In the middle is what was fitted."""
    hypothesis = Hypothesis(START).with_effect(MISMATCH, (0.1,)).with_effect(DEAD_TIME, (1000.0,))
    hypothesis = replace(hypothesis, shift=(*hypothesis.shift[:-1], 0.4))
    covariance = np.diag(np.array([0.01] * len(BASE) + [0.09, 0.04]))
    diagnosis = Diagnosis("effects", (), hypothesis, (step(4.0),), covariance)
    one = size_estimates(diagnosis, DEAD_TIME)["period_us"]
    half = Z_90 * np.hypot(0.2, DEFAULTS.reporting.systematic_log_sd)
    assert one.value == pytest.approx(1000 * np.exp(0.4))
    assert (one.low, one.high) == pytest.approx((one.value * np.exp(-half), one.value * np.exp(half)))
    other = size_estimates(diagnosis, MISMATCH)["sigma"]
    wider = Z_90 * np.hypot(0.3, DEFAULTS.reporting.systematic_log_sd)
    assert (other.value, other.high) == pytest.approx((0.1, 0.1 * np.exp(wider)))
