"""The ESIM pixel against its paper's formulas, and against a slow twin in plain Python."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.models.esim import Esim, EsimParameters

EPS = 0.001


def grey(log_intensity: float) -> float:
    """The grey level of ln(eps + I/255)."""
    return 255.0 * (math.exp(log_intensity) - EPS)


def one_pixel(parameters: EsimParameters, levels: list[float], step_us: int) -> list[tuple[int, bool]]:
    """Events (t, ON) of a pixel shown log intensities one step after another, from time 0 on."""
    model = Esim(1, 1, parameters)
    parts = [model.advance([[grey(level)]], i * step_us) for i, level in enumerate(levels)]
    return [(int(e["t"]), bool(e["p"])) for part in parts for e in part]


def exact(theta_on: float, theta_off: float, refractory_period_us: float = 0.0) -> EsimParameters:
    return EsimParameters(theta_on, theta_off, 0.0, refractory_period_us, EPS)


@pytest.mark.parametrize("way", [1.95, -1.95])
def test_a_ramp_gives_its_height_over_the_threshold_at_even_times(way: float) -> None:
    events = one_pixel(exact(0.3, 0.2), [-2.0, -2.0 + way], 10_000)
    theta = 0.3 if way > 0 else 0.2
    expected = [k * theta / abs(way) * 10_000 for k in range(1, int(abs(way) / theta) + 1)]
    assert [t for t, _ in events] == pytest.approx(expected, abs=1)
    assert {on for _, on in events} == {way > 0}


def test_frames_between_change_nothing_on_a_straight_line() -> None:
    whole = one_pixel(exact(0.3, 0.3), [-2.0, -0.05], 12_000)
    cut = one_pixel(exact(0.3, 0.3), np.linspace(-2.0, -0.05, 9).tolist(), 1500)
    assert [t for t, _ in cut] == pytest.approx([t for t, _ in whole], abs=1)


def test_in_the_refractory_period_the_level_moves_on_without_events() -> None:
    """Nine levels, one every 1000 us; with 2500 us dead time every third comes out. The level is then
    at +0.9, so that the next one down is +0.8."""
    parameters = exact(0.1, 0.1, refractory_period_us=2500)
    events = one_pixel(parameters, [-2.0, -1.05, -1.19, -1.21], 9500)
    assert [t for t, _ in events] == pytest.approx([1000, 4000, 7000, 23_750], abs=1)
    assert [on for _, on in events].count(
        False
    ) == 1  # memory at +0.9: one OFF level at +0.8, 0.149 takes it down to +0.801?


def test_thresholds_are_gaussian_over_pixels() -> None:
    """A rise of 1.6 in 1.6 s: the time of its event gives each pixel's own C. Limits at 5 standard errors: a
    chance of 1e-6 to fail."""
    side = 150
    model = Esim(side, side, EsimParameters(1.0, 1.0, 0.03, 0.0, EPS), seed=4)
    model.advance(np.full((side, side), grey(-3.0)), 0)
    events = model.advance(np.full((side, side), grey(-1.4)), 1_600_000)
    assert len(events) == side**2
    theta = (events["t"] + 0.5) / 1e6
    n = len(theta)
    assert theta.mean() == pytest.approx(1.0, abs=5 * 0.03 / n**0.5)
    assert theta.std() == pytest.approx(0.03, abs=5 * 0.03 / (2 * n) ** 0.5)


def test_thresholds_are_clipped_and_come_from_the_seed() -> None:
    def counts(seed: int) -> np.ndarray:
        model = Esim(40, 40, EsimParameters(0.05, 0.05, 0.2, 0.0, EPS), seed)
        model.advance(np.full((40, 40), grey(-2.0)), 0)
        events = model.advance(np.full((40, 40), grey(-1.0)), 1000)
        return np.bincount(events["y"].astype(int) * 40 + events["x"], minlength=1600)

    assert counts(1).max() in (99, 100)  # 1 / 0.01
    assert np.array_equal(counts(1), counts(1))
    assert not np.array_equal(counts(1), counts(2))


def twin(parameters: EsimParameters, images: np.ndarray, step_us: int) -> list[tuple[int, int, bool]]:
    """The published description pixel by pixel, thresholds all the same: (t, pixel, ON)."""
    found = []
    for pixel, grey_levels in enumerate(images.reshape(len(images), -1).T):
        levels = [math.log(parameters.log_eps + g / 255.0) for g in grey_levels]
        memory, last = levels[0], -math.inf
        for i in range(1, len(levels)):
            a, b = levels[i - 1], levels[i]
            on = b > a
            change = parameters.theta_on if on else -parameters.theta_off
            while a != b and (memory + change <= b if on else memory + change >= b):
                memory += change
                t = (i - 1) * step_us + (memory - a) / (b - a) * step_us
                if t - last >= parameters.refractory_period_us:
                    last = t
                    found.append((int(t), pixel, on))
    return sorted(found)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    theta_on=st.floats(0.05, 0.8),
    theta_off=st.floats(0.05, 0.8),
    dead_us=st.sampled_from([0.0, 900.0, 5000.0]),
)
def test_it_does_as_the_slow_twin(seed: int, theta_on: float, theta_off: float, dead_us: float) -> None:
    images = np.random.default_rng(seed).uniform(0, 255, (12, 3, 4))
    parameters = exact(theta_on, theta_off, dead_us)
    model = Esim(4, 3, parameters, seed)
    parts = [model.advance(image, i * 4000) for i, image in enumerate(images)]
    assert all((np.diff(part["t"]) >= 0).all() for part in parts)
    found = sorted((int(e["t"]), int(e["y"]) * 4 + int(e["x"]), bool(e["p"])) for p in parts for e in p)
    assert found == twin(parameters, images, 4000)


def test_wrong_images_change_nothing() -> None:
    model = Esim(2, 1, exact(0.5, 0.5))
    model.advance([[10, 10]], 100)
    with pytest.raises(ValueError, match="does not come after"):
        model.advance([[200, 200]], 100)
    with pytest.raises(ValueError, match=r"\(1, 3\).*\(1, 2\)"):
        model.advance([[1, 2, 3]], 200)
    assert len(model.advance([[10, 10]], 200)) == 0
