"""Parasitic photocurrent: ON events at a rate in proportion to brightness."""

import math

import pytest

from ..scenes import PIXELS, only, rate_hz


def test_parasitic_photocurrent_is_on_only_and_linear_in_brightness() -> None:
    parameters = only(parasitic_photocurrent={"k5_per_dn_us": 5e-9})
    for grey in (0, 64, 255):
        on, off = rate_hz(parameters, grey)
        assert off == 0
        # phases are uniform, so the count is within one event per pixel and binomial there
        assert on == pytest.approx(5e-3 * grey * PIXELS, abs=5 * math.sqrt(PIXELS / 4) / 20)
