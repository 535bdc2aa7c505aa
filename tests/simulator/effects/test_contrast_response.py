"""Contrast response: the logarithm of Eq. 1, and its linearisation of Eq. 10."""

import math

import pytest

from voltcam_simulator import Simulator

from ..scenes import PIXELS, SIDE, only, still


def test_contrast_response_answers_to_the_ratio_not_to_the_difference() -> None:
    parameters = only(contrast_response={"k1": 5, "k2_dn": 20})
    counts = []
    for first, last in ((0, 60), (20, 140), (100, 220)):
        simulator = Simulator(SIDE, SIDE, parameters, seed=3)
        simulator.advance(still(first, SIDE, SIDE), 0)
        counts.append(len(simulator.advance(still(last, SIDE, SIDE), 10_000)) / PIXELS)
    for count, ratio in zip(counts, (4, 4, 2), strict=True):
        assert count == pytest.approx(5 * math.log(ratio) - 0.5, abs=5 * math.sqrt(1 / 6 / PIXELS))


def test_linearised_response_is_eq_10() -> None:
    parameters = only(contrast_response={"k1": 5, "k2_dn": 20, "response": "linearised"})
    simulator = Simulator(SIDE, SIDE, parameters, seed=3)
    simulator.advance(still(0, SIDE, SIDE), 0)
    count = len(simulator.advance(still(60, SIDE, SIDE), 10_000)) / PIXELS
    assert count == pytest.approx(5 * 60 / (30 + 20) - 0.5, abs=5 * math.sqrt(1 / 6 / PIXELS))
