"""Parameters of a model that is fitted already, and how sure they are."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.precise import Precise, precise
from voltcam_lab.diagnosis.search.settings import DEFAULTS
from voltcam_lab.diagnosis.search.spread import spread_of

from ..made_rig import MISMATCH, START, MadeRig, response

TRUTH = (0.02, -0.01, 0.0, 0.03, -0.02, 0.01, np.log(0.31 / 0.3))
MODEL = Hypothesis(START).with_effect(MISMATCH, (0.3,))


def found(seed: int) -> Precise:
    rig = MadeRig()
    data = response(MODEL.parameters(TRUTH)) + rig.noise(seed)
    return precise(rig, MODEL, spread_of(rig, MODEL, DEFAULTS.runs.twins, DEFAULTS), DEFAULTS, data)


def test_a_fitted_model_is_moved_to_where_its_twins_say() -> None:
    assert found(99).hypothesis.shift == pytest.approx(TRUTH, abs=0.01)


def test_the_covariance_is_that_of_repeated_recordings() -> None:
    """Of 60, whose standard deviation is off by 9 % (one sigma); that of 28 twins is by 14 %. A factor of 2
    is beyond four sigma for each of seven parameters: false alarm in less than one of 1000."""
    many = [found(seed) for seed in range(100, 160)]
    sd = np.std([one.hypothesis.shift for one in many], axis=0, ddof=1)
    said = np.sqrt(np.diag(many[0].covariance))
    assert np.all(said > sd / 2)
    assert np.all(said < sd * 2)


def test_without_data_the_model_stays() -> None:
    rig = MadeRig()
    one = precise(rig, MODEL, spread_of(rig, MODEL, DEFAULTS.runs.twins, DEFAULTS), DEFAULTS)
    assert one.hypothesis.shift == MODEL.shift
    assert np.all(np.diag(one.covariance) <= MODEL.prior_sd(DEFAULTS) ** 2)
