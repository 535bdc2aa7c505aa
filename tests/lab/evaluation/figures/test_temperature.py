"""Leak against temperature: Arrhenius' law, and the figure."""

import numpy as np
import pytest
from tests.lab.pages.drawn import with_data

from voltcam_lab.evaluation.figures.noise import (
    still_noise_rates,
)
from voltcam_lab.evaluation.figures.temperature import LeakByTemperature, leak_by_temperature, temperature
from voltcam_simulator import Parameters

PUBLISHED = Parameters.of("paper")


def test_leak_follows_arrhenius_law() -> None:
    set_up = LeakByTemperature(side=48, seconds=40, temperatures_c=(25, 45, 65))
    dark = PUBLISHED.changed({"parasitic_photocurrent": {"k5_per_dn_us": 0}})
    rates = leak_by_temperature(set_up, dark)
    inverse = 1 / (np.array(set_up.temperatures_c) + 273.15)
    energy_ev = -np.polyfit(inverse, np.log(rates), 1)[0] * 8.617333262e-5
    assert energy_ev == pytest.approx(dark.junction_leak.activation_energy_ev, rel=0.02)
    assert rates[0] == pytest.approx(0.1, rel=0.05)


def test_the_figure_has_the_points_and_their_closed_form() -> None:
    set_up = LeakByTemperature(side=8, seconds=2, temperatures_c=(20, 60))
    rates = np.array([1.0, 3.0])
    figure = temperature(set_up, {"published": (PUBLISHED, rates)})
    assert with_data(figure) == 2
    line, points = figure.get_axes()[0].lines
    assert points.get_ydata().tolist() == rates.tolist()
    assert points.get_xdata() == pytest.approx([1000 / 293.15, 1000 / 333.15])
    for place, c in ((0, 20.0), (-1, 60.0)):
        on, _ = still_noise_rates(PUBLISHED.changed({"temperature_c": c}), np.array([128.0]))
        assert line.get_ydata()[place] == pytest.approx(on[0])
