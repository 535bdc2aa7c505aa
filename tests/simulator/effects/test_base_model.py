"""Each term of the paper's model by its signature in the events."""

import math

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.effects.junction_leak import arrhenius

from ..scenes import intervals_us, only, still, watch_still

SIDE = 60
PIXELS = SIDE * SIDE


def rate_hz(parameters: Parameters, grey: float, seconds: float = 20, seed: int = 1) -> tuple[float, float]:
    """ON and OFF events a second of a whole still sensor."""
    simulator = Simulator(SIDE, SIDE, parameters, seed=seed)
    events = watch_still(simulator, grey, seconds, 5)
    on = int(events["p"].sum())
    return on / seconds, (len(events) - on) / seconds


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


def test_parasitic_photocurrent_is_on_only_and_linear_in_brightness() -> None:
    parameters = only(parasitic_photocurrent={"k5_per_dn_us": 5e-9})
    for grey in (0, 64, 255):
        on, off = rate_hz(parameters, grey)
        assert off == 0
        # phases are uniform, so the count is within one event per pixel and binomial there
        assert on == pytest.approx(5e-3 * grey * PIXELS, abs=5 * math.sqrt(PIXELS / 4) / 20)


def test_leak_noise_spreads_the_leak_intervals() -> None:
    mu, sigma = 1e-6, 1e-4
    simulator = Simulator(SIDE, SIDE, only(junction_leak={"k4_per_us": mu}, leak_noise={"k6": sigma}), seed=2)
    between = intervals_us(watch_still(simulator, 10, 60, 5), SIDE)
    law = stats.invgauss(mu=sigma**2 / mu, scale=1 / sigma**2)
    assert stats.kstest(between, law.cdf).pvalue > 1e-4


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


@pytest.mark.parametrize(("sigma_factor", "rates"), [(30, (1 / 1.338, 0.0)), (300, (14.4, 13.6))])
@pytest.mark.parametrize("fps", [30, 240])
def test_strong_noise_meets_two_barriers(sigma_factor: float, rates: tuple[float, float], fps: int) -> None:
    """The design page's figures for L = 128, DAVIS346, with sigma times 30 and 300."""
    noisy = {"photon_noise": {"k3": 1e-4 * sigma_factor}, "leak_noise": {"k6": 1e-5 * sigma_factor}}
    simulator = Simulator(SIDE, SIDE, Parameters.of("paper").changed(noisy), seed=6)
    seconds = 40 if sigma_factor == 30 else 5
    events = watch_still(simulator, 128, seconds, fps)
    on = events["p"].mean() * len(events) / PIXELS / seconds
    off = (~events["p"]).mean() * len(events) / PIXELS / seconds
    if sigma_factor == 30:
        assert on + off == pytest.approx(rates[0], rel=0.01)
    else:
        assert (on, off) == pytest.approx(rates, rel=0.01)


def test_thresholds_set_the_polarity_ratio_of_noise() -> None:
    parameters = only(leak_noise={"k6": 1e-3}, comparator={"theta_on": 2.0, "theta_off": 0.5})
    on, off = rate_hz(parameters, 50, 10)
    # leaves (-1/2, 2) at the top with probability 1/5, after a mean time of 2 * 1/2 / sigma^2
    assert on / (on + off) == pytest.approx(0.2, abs=0.01)
    assert on + off == pytest.approx(PIXELS, rel=0.03)


def test_static_ramp_has_the_paper_s_figure_6() -> None:
    """ON noise rises with intensity as mu(L), OFF is nearly zero."""
    ramp = np.tile(np.arange(256, dtype=np.uint8), (64, 1))
    simulator = Simulator(256, 64, Parameters.of("paper"), seed=8)
    events = np.concatenate([simulator.advance(ramp, t) for t in range(0, 30_000_001, 200_000)])
    on = np.bincount(events["x"][events["p"]], minlength=256) / 64 / 30
    expected = (1e-7 + 5e-9 * np.arange(256)) * 1e6
    # within one event per pixel of 30 s of a renewal process: 5 standard deviations of a uniform phase
    np.testing.assert_allclose(on, expected, atol=5 * 0.5 / math.sqrt(64) / 30)
    assert (~events["p"]).sum() < 0.001 * len(events)
