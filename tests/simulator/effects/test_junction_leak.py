"""Junction leak: ON events at a rate that only the temperature changes."""

import math

import pytest

from voltcam_simulator.effects.junction_leak import arrhenius

from ..scenes import PIXELS, only, rate_hz


@pytest.mark.parametrize("grey", [0, 128, 255])
def test_junction_leak_is_on_only_and_the_same_at_all_brightnesses(grey: float) -> None:
    on, off = rate_hz(only(junction_leak={"k4_per_us": 1e-7}), grey)
    assert off == 0
    # no noise: two events in 20 s for each pixel exactly, phases uniform
    assert on == pytest.approx(0.1 * PIXELS, abs=1 / 20)


@pytest.mark.parametrize("temperature_c", [15, 35, 60])
def test_junction_leak_follows_arrhenius(temperature_c: float) -> None:
    cold = only(junction_leak={"k4_per_us": 1e-6})
    warm = cold.changed({"temperature_c": temperature_c})
    factor = rate_hz(warm, 128)[0] / rate_hz(cold, 128)[0]
    assert factor == pytest.approx(arrhenius(temperature_c, 0.56), rel=0.01)


def test_arrhenius_against_numbers_worked_out_by_hand() -> None:
    # 0.56 eV / 8.617333e-5 eV/K = 6498.5 K; 1/308.15 - 1/298.15 = -1.08845e-4 /K
    assert arrhenius(35, 0.56) == pytest.approx(math.exp(6498.5 * 1.08845e-4), rel=1e-4)
    assert arrhenius(25, 0.56) == 1
    assert arrhenius(15, 0.56) < 0.5
