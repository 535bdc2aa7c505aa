"""Forms of the open route."""

import pytest

from voltcam_lab.diagnosis.catalogue.candidate import Candidate
from voltcam_lab.diagnosis.search import unlisted
from voltcam_lab.diagnosis.search.settings import OpenRoute
from voltcam_simulator import Parameters

ROUTE = OpenRoute()


def forms(start: Parameters, whole: bool = True) -> tuple[Candidate, ...]:
    return unlisted.forms(start, ROUTE, whole)


def test_forms_of_the_open_route_are_drifts_and_noises() -> None:
    assert {one.effect for one in forms(Parameters.of("paper"))} == {"residual_drift", "residual_noise"}


def test_drifts_are_tried_either_way_below_and_above_the_leak() -> None:
    """A small one slows the leak, a large one turns it round: neither is the other's multiple."""
    start = Parameters.of("paper")
    leak = start.junction_leak.k4_per_us + 128 * start.parasitic_photocurrent.k5_per_dn_us
    for form in forms(start):
        if form.effect == "residual_drift":
            found = [form.on(start, size).residual_drift for size in form.sizes]
            most = [one.per_us * max(1, one.across, one.down) / leak for one in found]
            ways_and_sizes = {(size > 0, abs(size) > 1) for size in most}
            assert ways_and_sizes == {(True, True), (True, False), (False, True), (False, False)}


def test_across_the_image_nothing_is_looked_for_in_strips_of_it() -> None:
    start = Parameters.of("paper")
    of_strips = forms(start, whole=False)
    assert [one.others for one in forms(start) if one not in of_strips] == [
        {"power": 0.0, "across": ROUTE.steepness}
    ]


@pytest.mark.parametrize("axis", ["across", "down"])
def test_slopes_over_the_image_have_next_to_no_drift_in_the_middle(axis: str) -> None:
    start = Parameters.of("paper")
    (slope,) = (one for one in forms(start) if axis in one.others)
    for size in slope.sizes:
        drift = slope.on(start, size).residual_drift
        assert abs(drift.per_us) < 0.2 * abs(drift.per_us * getattr(drift, axis))
