"""The v2e pixel against its paper's formulas, and against a slow twin in plain Python."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.models.v2e import V2e, V2eParameters

QUIET = V2eParameters(0.2, 0.2, theta_sigma=0, leak_rate_hz=0, leak_jitter=0, leak_mismatch_decades=0)


def lin_log(grey: float) -> float:
    return math.log(grey) if grey > 20 else grey * math.log(20) / 20


def show(model: V2e, greys: list[float], step_us: int) -> np.ndarray:
    """Events of uniform images one step after another, from time 0 on."""
    images = [np.full((model.height, model.width), grey) for grey in greys]
    return np.concatenate([model.advance(image, i * step_us) for i, image in enumerate(images)])


@pytest.mark.parametrize(("a", "b"), [(30, 200), (200, 30), (0, 20), (3, 250), (20, 20.5)])
def test_a_step_gives_its_lin_log_height_over_the_threshold_evenly_spread(a: float, b: float) -> None:
    events = show(V2e(1, 1, replace(QUIET, theta_off=0.3)), [a, b], 10_000)
    n = int(abs(lin_log(b) - lin_log(a)) / (0.2 if b > a else 0.3))
    assert len(events) == n
    assert events["t"].tolist() == [10_000 * k // n for k in range(1, n + 1)]
    assert (events["p"] == (b > a)).all()


def test_times_are_spread_over_the_most_that_any_pixel_gives() -> None:
    model = V2e(2, 1, QUIET)
    model.advance([[30, 30]], 0)
    events = model.advance([[30 * math.exp(0.41), 30 * math.exp(0.81)]], 8000)
    assert events["t"][events["x"] == 1].tolist() == [2000, 4000, 6000, 8000]
    assert events["t"][events["x"] == 0].tolist() == [2000, 4000]


def test_the_rest_is_remembered() -> None:
    """Ten steps of 0.15 with thresholds of 0.2: 7 events, as one step of 1.5."""
    greys = [30 * math.exp(0.15 * k) for k in range(11)]
    assert len(show(V2e(1, 1, QUIET), greys, 1000)) == 7


def test_within_the_refractory_period_events_are_lost_and_the_level_stays() -> None:
    model = V2e(1, 1, replace(QUIET, refractory_period_us=2500))
    events = show(model, [30, 30 * math.exp(0.81), 30 * math.exp(0.81)], 4000)  # at 1000..4000, 2 lost
    assert events["t"].tolist() == [1000, 4000, 8000]  # two were owed, at 6000 and 8000


@pytest.mark.parametrize("grey", [20, 100, 255])
def test_the_low_pass_has_a_time_constant_inverse_to_intensity(grey: float) -> None:
    """A step up; its n-th threshold is crossed at tau ln(1/(1 - n theta/height)), to a frame."""
    start, cutoff, step_us = grey / math.exp(0.5), 20.0, 20
    height = lin_log(grey) - lin_log(start)
    model = V2e(1, 1, replace(QUIET, cutoff_hz=cutoff))
    events = show(model, [start] + [grey] * 8000, step_us)
    tau_us = 1e6 / (2 * math.pi * cutoff) * 275 / (grey + 20)
    expected = [tau_us * -math.log(1 - n * 0.2 / height) for n in range(1, int(height / 0.2) + 1)]
    assert events["t"].tolist() == pytest.approx(expected, abs=2.5 * step_us, rel=5e-3)


def test_thresholds_are_gaussian_over_pixels() -> None:
    """The number of events of a tall step is floor(height/theta), theta ~ N(0.2, 0.03): mean and spread of it
    against 10^6 draws. Limits at 5 standard errors: a chance of about 1e-6 to fail."""
    side, height = 100, math.log(250 / 20)
    events = show(V2e(side, side, replace(QUIET, theta_sigma=0.03), seed=3), [20, 250], 1000)
    counts = np.bincount(events["y"].astype(int) * side + events["x"], minlength=side**2)
    theta = np.maximum(np.random.default_rng(0).normal(0.2, 0.03, 10**6), 0.01)
    expected = np.floor(height / theta)
    error = expected.std() / side
    assert counts.mean() == pytest.approx(expected.mean(), abs=5 * error)
    assert counts.std() == pytest.approx(
        expected.std(), rel=5 * math.sqrt(2) / side
    )  # the law has heavy tails


def test_the_leak_makes_on_events_at_its_rate_in_every_pixel_from_the_start() -> None:
    """0.5 Hz for 20 s in 400 pixels, whatever their thresholds: 10 events in each; log-normal mismatch of 0.1
    decade adds a mean of exp((0.1 ln 10)^2/2) and a spread of 0.23."""
    side, rate, seconds = 40, 0.5, 20
    steady = replace(QUIET, leak_rate_hz=rate, theta_sigma=0.03)
    events = show(V2e(side, side, steady, seed=1), [100] * (seconds * 50 + 1), 20_000)
    assert events["p"].all()
    counts = np.bincount(events["y"].astype(int) * side + events["x"], minlength=side**2)
    assert set(counts.tolist()) <= {9, 10, 11}
    first_second = np.count_nonzero(events["t"] < 1_000_000)
    assert first_second == pytest.approx(rate * side**2, abs=5 * math.sqrt(side**2 * 0.25))
    mixed = replace(steady, leak_jitter=0.1, leak_mismatch_decades=0.1)
    events = show(V2e(side, side, mixed, seed=1), [100] * (seconds * 50 + 1), 20_000)
    counts = np.bincount(events["y"].astype(int) * side + events["x"], minlength=side**2)
    sigma = 0.1 * math.log(10)
    mean, spread = math.exp(sigma**2 / 2), math.sqrt(math.exp(sigma**2) - 1) * math.exp(sigma**2 / 2)
    assert counts.mean() == pytest.approx(10 * mean, abs=5 * 10 * spread / side)
    assert counts.std() == pytest.approx(10 * spread, rel=0.15)


def test_jitter_makes_leak_intervals_irregular() -> None:
    """Of one pixel at 5 Hz, jitter 0.5 per frame of 1 ms: 200 frames add up to a relative 0.5/sqrt(200)."""
    model = V2e(30, 30, replace(QUIET, leak_rate_hz=5, leak_jitter=0.5), seed=2)
    events = show(model, [100] * 4001, 1000)
    order = np.lexsort((events["t"], events["x"], events["y"]))
    pixel = (events["y"].astype(int) * 30 + events["x"])[order]
    gaps = np.diff(events["t"][order])[np.diff(pixel) == 0]
    assert gaps.mean() == pytest.approx(200_000, rel=5 * 0.036 / math.sqrt(len(gaps)) + 1e-3)
    assert gaps.std() == pytest.approx(200_000 * 0.5 / math.sqrt(200), rel=0.05)


@pytest.mark.parametrize("grey", [0, 60, 128, 255])
def test_shot_noise_falls_from_its_rate_in_the_dark_to_a_quarter(grey: float) -> None:
    """rate (1 - 0.75 (I + 20)/275), half of it ON. Poisson counts, limits at 5 sigma."""
    side, rate, seconds = 40, 10.0, 4
    events = show(
        V2e(side, side, replace(QUIET, shot_noise_rate_hz=rate), seed=5), [grey] * (seconds * 500 + 1), 2000
    )
    expected = rate * seconds * side**2 * (1 - 0.75 * (grey + 20) / 275)
    assert len(events) == pytest.approx(expected, abs=5 * math.sqrt(expected))
    assert np.count_nonzero(events["p"]) == pytest.approx(expected / 2, abs=5 * math.sqrt(expected / 2))


def test_shot_noise_is_rarer_at_higher_thresholds() -> None:
    """In proportion to nominal over actual: pixels cut at the median of their own threshold differ."""
    own = replace(QUIET, shot_noise_rate_hz=20.0, theta_sigma=0.03)
    model = V2e(60, 60, own, seed=6)
    counts = np.zeros(3600)
    events = show(model, [50] * 2001, 2000)
    events = events[events["p"]]
    np.add.at(counts, events["y"].astype(int) * 60 + events["x"], 1)
    rise = model.advance(np.full((60, 60), 255.0), 4_002_000)  # many events: few where the threshold is high
    signal = np.bincount(rise["y"].astype(int) * 60 + rise["x"], minlength=3600)
    low = signal > np.median(signal)
    high = signal < np.median(signal)
    assert counts[low].mean() > 1.1 * counts[high].mean()


def test_published_presets() -> None:
    clean, noisy = V2eParameters.clean(), V2eParameters.noisy()
    assert (clean.theta_on, clean.theta_sigma, clean.cutoff_hz) == (0.2, 0.02, 0)
    assert (clean.leak_rate_hz, clean.shot_noise_rate_hz, clean.refractory_period_us) == (0, 0, 0)
    assert (noisy.theta_off, noisy.theta_sigma, noisy.cutoff_hz) == (0.2, 0.05, 30)
    assert (noisy.leak_rate_hz, noisy.leak_jitter, noisy.leak_mismatch_decades) == (0.1, 0.1, 0.1)
    assert (noisy.shot_noise_rate_hz, noisy.refractory_period_us) == (5, 0)


def twin(own: V2eParameters, images: np.ndarray, step_us: int) -> list[tuple[int, int, bool]]:
    """The published description without its random parts: (t, pixel, ON)."""
    flat = images.reshape(len(images), -1)
    pixels = range(flat.shape[1])
    photo = [lin_log(g) for g in flat[0]]
    memory, last = list(photo), [-math.inf] * len(photo)
    found = []
    for frame in range(1, len(flat)):
        owed = []
        for i in pixels:
            tau_s = 1 / (2 * math.pi * own.cutoff_hz) if own.cutoff_hz else 0.0
            share = (flat[frame, i] + 20) / 275 * step_us * 1e-6 / tau_s if tau_s else 1.0
            photo[i] += min(share, 1.0) * (lin_log(flat[frame, i]) - photo[i])
            up = photo[i] - memory[i]
            owed.append(math.floor(up / own.theta_on) if up > 0 else -math.floor(-up / own.theta_off))
        most = max(max(map(abs, owed)), 1)
        for i in pixels:
            for k in range(1, abs(owed[i]) + 1):
                t = (frame - 1) * step_us + k * step_us / most
                if t - last[i] >= own.refractory_period_us:
                    last[i] = t
                    memory[i] += own.theta_on if owed[i] > 0 else -own.theta_off
                    found.append((int(t), i, owed[i] > 0))
    return sorted(found)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    theta_on=st.floats(0.05, 0.8),
    theta_off=st.floats(0.05, 0.8),
    cutoff_hz=st.sampled_from([0.0, 7.0, 30.0]),
    dead_us=st.sampled_from([0.0, 900.0, 5000.0]),
)
def test_it_does_as_the_slow_twin(
    seed: int, theta_on: float, theta_off: float, cutoff_hz: float, dead_us: float
) -> None:
    images = np.random.default_rng(seed).uniform(0, 255, (12, 3, 4))
    own = replace(
        QUIET, theta_on=theta_on, theta_off=theta_off, cutoff_hz=cutoff_hz, refractory_period_us=dead_us
    )
    model = V2e(4, 3, own, seed)
    parts = [model.advance(image, i * 4000) for i, image in enumerate(images)]
    assert all((np.diff(part["t"]) >= 0).all() for part in parts)
    found = sorted((int(e["t"]), int(e["y"]) * 4 + int(e["x"]), bool(e["p"])) for p in parts for e in p)
    assert found == twin(own, images, 4000)
