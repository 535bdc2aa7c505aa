"""Photon noise: events of both polarities, most of them at the dark level."""

import math

import pytest

from ..scenes import PIXELS, only, rate_hz


def test_photon_noise_makes_both_polarities_most_at_the_dark_level() -> None:
    parameters = only(photon_noise={"k3": 1e-2}, contrast_response={"k1": 5, "k2_dn": 20})
    rates = {grey: rate_hz(parameters, grey, 10) for grey in (0, 5, 20, 200)}
    assert rates[0] == (0, 0)
    for grey in (5, 20, 200):
        on, off = rates[grey]
        sigma = 1e-2 * math.sqrt(grey) / (grey + 20)
        # driftless from the middle of a band of half width 1: mean exit time 1/sigma^2, each side half
        expected = sigma**2 * 1e6 * PIXELS / 2
        assert on == pytest.approx(expected, rel=0.03)
        assert off == pytest.approx(expected, rel=0.03)
    assert sum(rates[20]) > sum(rates[5]) > sum(rates[200])
