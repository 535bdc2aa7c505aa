"""Figures of events: maps of pixels, spectra, and phases in the frame."""

import numpy as np
import pytest
from matplotlib.patches import StepPatch
from tests.lab.statistics.streams import HEIGHT, PERIOD_US, WIDTH, poisson, still

from voltcam_lab.diagnosis.outcome.figures_events import (
    frame_phase_histograms,
    pixel_maps,
    spectrum_curves,
)

SECONDS = 4.0
SETTING = still(SECONDS)


def both(rate_hz: object = 10.0, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.concatenate([poisson(rng, rate_hz, SECONDS, on) for on in (True, False)])


def test_maps_are_rates_and_spreads_of_chance() -> None:
    """The model has one pixel with ten times the events."""
    rate_hz = np.full(WIDTH * HEIGHT, 10.0)
    rate_hz[77] = 100
    measured, model = both(seed=1), both(rate_hz, seed=2)
    panels = pixel_maps({"measured": [measured], "model": [model]}, SETTING).get_axes()
    counts = [
        np.bincount(events["y"].astype(int) * WIDTH + events["x"], minlength=WIDTH * HEIGHT).reshape(
            HEIGHT, WIDTH
        )
        for events in (measured, model)
    ]
    assert np.asarray(panels[0].images[0].get_array()) == pytest.approx(counts[0] / SECONDS)
    z = (counts[1] - counts[0]) / np.sqrt(counts[0] + counts[1] + 1)
    assert np.asarray(panels[3].images[0].get_array()) == pytest.approx(z)
    assert np.argmax(z) == 77


def test_a_spectrum_has_its_line_where_the_light_flickers() -> None:
    """ON and OFF by turns, 100 times a second; elsewhere about 1 where events come at random."""
    free = both(seed=3)
    turn = np.where(free["p"], 1, -1) * np.sin(2 * np.pi * 100 * free["t"] * 1e-6)
    locked = free[np.random.default_rng(4).random(len(free)) < (1 + turn) / 2]
    (panel,) = spectrum_curves({"measured": [free], "model": [locked]}, SETTING).get_axes()
    (curve,) = [line for line in panel.lines if len(line.get_xdata()) > 2]
    hz, amplitude = curve.get_data()
    assert hz[np.argmax(amplitude)] == pytest.approx(100, abs=1.5)
    # At full depth the mean of +-exp(2 pi i f t) is 1/2.
    assert amplitude.max() == pytest.approx(np.sqrt(len(locked)) / 2, rel=0.1)
    assert np.median(amplitude) < 3
    (filled,) = [path.get_paths()[0].vertices for path in panel.collections]
    assert filled[:, 1].max() < 5  # of 4000 exponential powers one is above 25 once in 10 million times


def test_phases_crowd_where_the_frame_is_read() -> None:
    """All events of the model 3 ms after each frame, of 10 ms; each stream has shares of its own mean."""
    free = both(seed=5)
    locked = free.copy()
    locked["t"] = locked["t"] // PERIOD_US * PERIOD_US + 3050
    figure = frame_phase_histograms({"measured": [free], "model": [locked]}, SETTING)
    on, off = figure.get_axes()[:2]
    for panel in (on, off):
        measured, model = [patch.get_data() for patch in panel.patches if isinstance(patch, StepPatch)]
        assert measured.values.mean() == pytest.approx(1)
        assert model.values.mean() == pytest.approx(1)
        (at,) = np.flatnonzero(model.values)
        assert model.edges[at] <= 3.05 < model.edges[at + 1]
        assert measured.values.min() > 0.5


def test_a_scan_of_rows_runs_down_the_image() -> None:
    events = both(seed=6)
    row_us = PERIOD_US // HEIGHT
    events["t"] = events["t"] // PERIOD_US * PERIOD_US + events["y"].astype(int) * row_us + row_us // 2
    figure = frame_phase_histograms({"measured": [both(seed=7)], "model": [events]}, SETTING)
    images = [np.asarray(image.get_array()) for axes in figure.get_axes() for image in axes.images]
    scan = images[1]
    assert scan.shape[0] == HEIGHT
    phase = (scan.argmax(axis=1) + 0.5) / scan.shape[1]
    assert phase == pytest.approx((np.arange(HEIGHT) + 0.5) / HEIGHT, abs=0.6 / scan.shape[1] + 0.6 / HEIGHT)
