"""Closed forms behind the figures, and that every figure comes out, the same each time."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from voltcam_lab.distances import FrameLight, NoiseRates, Region
from voltcam_lab.distances.counts import count_images, watched
from voltcam_lab.distances.inter_event_intervals import IntervalStrata, same_polarity
from voltcam_lab.evaluation.figures.dots import dots
from voltcam_lab.evaluation.figures.noise import (
    HeldImage,
    noise_against_intensity,
    noise_in_recording,
    still_noise_rates,
)
from voltcam_lab.evaluation.figures.temperature import LeakByTemperature, leak_by_temperature, temperature
from voltcam_lab.pages.clouds import busiest, clouds, time_surface
from voltcam_lab.pages.histograms import interval_histograms
from voltcam_lab.pages.residuals import residual_maps
from voltcam_lab.pages.style import as_uri, save
from voltcam_simulator import EVENT, Parameters, Simulator
from voltcam_simulator.effect import Events

PUBLISHED = Parameters.of("paper")
NOISY = PUBLISHED.changed({"photon_noise": {"k3": 3e-3}, "leak_noise": {"k6": 3e-4}})
WIDTH, HEIGHT = 96, 80


def some_events(seed: int, size: int = 20_000) -> Events:
    rng = np.random.default_rng(seed)
    events = np.empty(size, EVENT)
    events["t"] = np.sort(rng.integers(0, 1_000_000, size))
    events["x"], events["y"] = rng.integers(0, WIDTH, size), rng.integers(0, HEIGHT, size)
    events["p"] = rng.random(size) < 0.5
    return events


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


def test_leak_follows_arrhenius_law() -> None:
    set_up = LeakByTemperature(side=48, seconds=40, temperatures_c=(25, 45, 65))
    dark = PUBLISHED.changed({"parasitic_photocurrent": {"k5_per_dn_us": 0}})
    rates = leak_by_temperature(set_up, dark)
    inverse = 1 / (np.array(set_up.temperatures_c) + 273.15)
    energy_ev = -np.polyfit(inverse, np.log(rates), 1)[0] * 8.617333262e-5
    assert energy_ev == pytest.approx(dark.junction_leak.activation_energy_ev, rel=0.02)
    assert rates[0] == pytest.approx(0.1, rel=0.05)


def test_a_time_surface_is_each_pixels_last_event_decayed() -> None:
    events = np.array(
        [(1000, 1, 2, True), (4000, 1, 2, False), (7000, 3, 0, True), (7500, 0, 0, True)], EVENT
    )
    surface = time_surface(events, 7000, 4, 3)  # the last two are not before it
    assert surface[2, 1] == pytest.approx(-np.exp(-1))
    assert np.count_nonzero(surface) == 1


def test_the_busiest_window_is_where_events_are() -> None:
    events = some_events(1, 5000)
    crowd = some_events(2, 20_000)
    crowd["t"] = np.sort(500_000 + crowd["t"] // 20)
    crowd["x"] = 70 + crowd["x"] % 20
    window = busiest(np.sort(np.concatenate([events, crowd]), order="t"), WIDTH, HEIGHT)
    assert window.begin_us <= 520_000 < window.begin_us + window.span_us
    assert window.x <= 70
    assert window.x + window.side >= 90
    assert busiest(events[:0], WIDTH, HEIGHT).begin_us == 0


def all_figures() -> dict[str, Figure]:
    real, simulated = some_events(1), some_events(2)
    region = Region.whole(WIDTH, HEIGHT, 0, 1_000_000)
    light = FrameLight(
        np.random.default_rng(0).integers(0, 255, (11, HEIGHT, WIDTH)).astype(np.uint8),
        np.arange(11, dtype=np.int64) * 100_000,
    )
    intervals = {
        name: same_polarity(events, region) for name, events in (("real", real), ("exact", simulated))
    }
    images = count_images(real, region), count_images(simulated, region)
    held, set_up = HeldImage(4, 10, 1.0), LeakByTemperature(side=8, seconds=2, temperatures_c=(20, 60))
    noise = NoiseRates(np.arange(0.0, 65, 32), np.array([1.0, np.nan]), np.zeros(2), np.array([10.0, 0.0]))
    row = {"W1": 0.1, "TVs": 0.2, "pair": 0.1, "b4": 0.9, "AUC": float("nan")}
    rates = {"exact": held.rates(Simulator(4, 10, NOISY))}
    return {
        "clouds": clouds({"real": real, "exact": simulated}, intervals, busiest(real, 96, 80), 96, 80),
        "histograms": interval_histograms(
            intervals["real"], {"exact": intervals["exact"]}, IntervalStrata.of(intervals["real"], light)
        ),
        "residuals": residual_maps(images[0], {"exact": images[1]}, watched(region)),
        "dots": dots({"exact": row}, {"pixels": {**row, "AUC": 0.5}}),
        "noise": noise_against_intensity(held, {"noisy": (NOISY, rates)}),
        "noise at rest": noise_in_recording(noise, {"exact": noise}),
        "temperature": temperature(
            set_up, {"published": (PUBLISHED, leak_by_temperature(set_up, PUBLISHED))}
        ),
    }


def test_all_figures_are_drawn(tmp_path: Path) -> None:
    for name, figure in all_figures().items():
        path = tmp_path / f"{name}{'.svg' if name in ('dots', 'residuals') else '.png'}"
        save(figure, path)
        written = path.read_bytes()
        assert written.startswith(b"<?xml" if path.suffix == ".svg" else b"\x89PNG"), name


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_a_figure_is_the_same_each_time(tmp_path: Path, suffix: str) -> None:
    path, row = tmp_path / f"dots{suffix}", {"W1": 0.1, "TVs": 0.2, "pair": 0.1, "b4": 0.9, "AUC": 0.8}
    written = []
    for _ in range(2):
        save(dots({"exact": row}, {"pixels": {name: value / 2 for name, value in row.items()}}), path)
        written.append(path.read_bytes())
    assert written[0] == written[1]


def test_a_figure_goes_into_a_page() -> None:
    figure = Figure((1, 1))
    assert as_uri(figure).startswith("data:image/svg+xml;base64,")
    assert as_uri(figure, "png").startswith("data:image/png;base64,")
