"""Unequal thresholds."""

import pytest

from voltcam_lab.diagnosis.catalogue.entries import catalogue
from voltcam_lab.models.exact import IN_THRESHOLDS, K1_TO_K6
from voltcam_simulator import Parameters

from ..made_rig import made_clues

CLUES = made_clues()
SCALED = [K1_TO_K6[name] for name in IN_THRESHOLDS]


def test_unequal_thresholds_keep_their_product_and_the_on_events() -> None:
    asymmetry = next(one for one in catalogue(CLUES) if one.effect == "comparator")
    before = Parameters.of("paper")
    after = asymmetry.on(before, (1.3,))
    comparator = after.comparator
    assert comparator.theta_on / comparator.theta_off == pytest.approx(1.3)
    assert comparator.theta_on * comparator.theta_off == pytest.approx(1)
    for effect, name in SCALED:
        now, then = (getattr(getattr(one, effect), name) for one in (after, before))
        assert now / comparator.theta_on == pytest.approx(then)
