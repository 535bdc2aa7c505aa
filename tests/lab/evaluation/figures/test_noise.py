"""Noise of a held image: the closed form, the exact law on it, and the figures."""

import numpy as np
import pytest
from tests.lab.pages.drawn import with_data

from voltcam_lab.distances import NoiseRates
from voltcam_lab.evaluation.figures.noise import (
    HeldImage,
    noise_against_intensity,
    noise_in_recording,
    still_noise_rates,
)
from voltcam_simulator import Parameters, Simulator

PUBLISHED = Parameters.of("paper")


NOISY = PUBLISHED.changed({"photon_noise": {"k3": 3e-3}, "leak_noise": {"k6": 3e-4}})


def test_rates_at_rest_without_noise_are_drift_over_threshold() -> None:
    quiet = PUBLISHED.changed({"photon_noise": {"k3": 0}, "leak_noise": {"k6": 1e-9}})
    on, off = still_noise_rates(quiet.changed({"comparator": {"theta_on": 2.0}}), np.array([0.0, 100.0]))
    assert on == pytest.approx([1e6 * 1e-7 / 2, 1e6 * (1e-7 + 5e-7) / 2])
    assert not off.any()


def test_rates_at_rest_without_drift_are_those_of_diffusion() -> None:
    """sigma^2 / (a (a + b)) up, sigma^2 / (b (a + b)) down."""
    still = PUBLISHED.changed({
        "photon_noise": {"k3": 0}, "leak_noise": {"k6": 1e-3}, "junction_leak": {"k4_per_us": 0},
        "parasitic_photocurrent": {"k5_per_dn_us": 0}, "comparator": {"theta_on": 1.0, "theta_off": 0.5},
    })  # fmt: skip
    on, off = still_noise_rates(still, np.array([100.0]))
    assert on == pytest.approx(1.0 / 1.5, rel=1e-3)
    assert off == pytest.approx(1.0 / 0.75, rel=1e-3)


@pytest.mark.parametrize("parameters", [PUBLISHED, NOISY], ids=["published", "noisy"])
def test_the_exact_law_is_on_the_line(parameters: Parameters) -> None:
    held = HeldImage(intensities=8, rows=400, seconds=20, fps=10)
    measured = held.rates(Simulator(8, 400, parameters, seed=3))
    expected = still_noise_rates(parameters, held.levels_dn)
    for rates, line in zip(measured, expected, strict=True):
        counts = line * held.rows * held.seconds
        assert (np.abs(rates - line) * held.rows * held.seconds <= 5 * np.sqrt(counts + 1)).all()


def test_the_figure_has_points_and_lines_of_both_polarities() -> None:
    held = HeldImage(4, 10, 1.0)
    figure = noise_against_intensity(held, {"noisy": (NOISY, {"exact": held.rates(Simulator(4, 10, NOISY))})})
    assert with_data(figure) == 2 + 2


def test_the_figure_of_a_recording_has_the_real_rates_and_the_models_and_no_unseen_light() -> None:
    noise = NoiseRates(np.arange(0.0, 65, 32), np.array([1.0, np.nan]), np.zeros(2), np.array([10.0, 0.0]))
    figure = noise_in_recording(noise, {"exact": noise})
    assert with_data(figure) == 2
    on, off = figure.get_axes()
    assert [np.isfinite(line.get_ydata()).tolist() for line in on.lines] == 2 * [[True, False]]
    assert not any(np.isfinite(line.get_ydata()).any() for line in off.lines)
