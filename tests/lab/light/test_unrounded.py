"""Light before it was rounded."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from voltcam_lab.light.unrounded import rounding_errors, unrounded

TEXTURE = np.random.default_rng(1).uniform(0, 40, (16, 16))  # pixels pass a level at different times


def rounded(light: np.ndarray) -> np.ndarray:
    return np.rint(light).astype(np.uint8)


def test_slow_light_is_found_between_the_levels() -> None:
    light = np.linspace(10, 16, 200)[:, None, None] + TEXTURE
    error = (unrounded(rounded(light)) - light)[40:-40]  # but for the first level and the last
    assert np.sqrt((error**2).mean()) < 0.1  # of rounding alone: 0.29


def test_it_goes_on_only_while_its_surroundings_do() -> None:
    ramp = np.concatenate([np.linspace(10, 12.2, 60), np.full(80, 12.2), np.linspace(12.2, 15, 60)])
    light = unrounded(rounded(ramp[:, None, None] + TEXTURE))
    assert np.ptp(light[64:136], axis=0).max() < 0.02


def test_light_that_turns_within_a_level_is_nearer_than_the_level() -> None:
    swing = TEXTURE + 1.4 * np.sin(np.linspace(0, 6 * np.pi, 300))[:, None, None]
    taken = rounded(swing + 10)
    error, of_rounding = (np.abs(each - swing - 10).mean() for each in (unrounded(taken), taken))
    assert error < 0.5 * of_rounding


@settings(max_examples=60, deadline=None)
@given(arrays(np.uint8, (12, 3, 4), elements=st.integers(0, 255)))
def test_it_rounds_to_the_frames(frames: np.ndarray) -> None:
    assert np.abs(unrounded(frames) - frames).max() <= 0.5


def test_frames_that_never_change_stay() -> None:
    frames = np.full((20, 4, 4), 7, np.uint8)
    assert unrounded(frames) == pytest.approx(frames)


def test_waves_of_many_levels_lose_most_of_their_zigzag() -> None:
    """A step from frame to frame errs by 0.41 with rounding: 2/12 is its variance. A cubic through 5 of them
    leaves half of that."""
    phase = (
        np.linspace(0, 12 * np.pi, 300)[:, None, None] + 0.3 * np.arange(16) + 0.2 * np.arange(16)[:, None]
    )
    wave = 100 + 20 * np.sin(phase)
    error = np.diff(unrounded(rounded(wave)) - wave, axis=0)
    assert error.std() < 0.55 * np.sqrt(2 / 12)


def test_edges_stay_where_they_are() -> None:
    edge = np.where(np.arange(40)[:, None, None] < 20 + np.arange(8), 40.0, 160.0) * np.ones((1, 8, 1))
    assert unrounded(rounded(edge)) == pytest.approx(edge, abs=0.5)


def test_errors_of_rounding_are_as_large_as_they_are() -> None:
    """Of a wave of which everything is known, also from one frame to the next."""
    phase = (
        np.linspace(0, 12 * np.pi, 300)[:, None, None] + 0.3 * np.arange(16) + 0.2 * np.arange(16)[:, None]
    )
    for amplitude in (4, 20):
        wave = 30 + amplitude * np.sin(phase)
        light = unrounded(rounded(wave))
        told = rounding_errors(light).astype(np.float32)
        assert np.abs(light + told[0] - wave).max() < 2  # of it, not of something else
        for measure in (np.std, lambda error: np.std(np.diff(error, axis=-3))):
            ratio = np.sqrt(np.mean([measure(error) ** 2 for error in told])) / measure(light - wave)
            assert 0.6 < ratio < 1.6


def test_errors_of_rounding_what_cosines_do_not_tell_change_from_frame_to_frame() -> None:
    """Texture without any order that goes by: what is found of it is nearly as it was rounded."""
    rng = np.random.default_rng(2)
    texture = 60 + 15 * rng.standard_normal((16, 80))
    wave = np.stack([texture[:, k : k + 16] for k in range(60)])
    light = unrounded(rounded(wave))
    for error in rounding_errors(light).astype(np.float32):
        for measure in (np.std, lambda error: np.std(np.diff(error, axis=-3))):
            assert measure(error) == pytest.approx(measure(light - wave), rel=0.25)


def test_light_at_rest_may_be_off_but_rests() -> None:
    told = rounding_errors(np.full((20, 4, 4), 7, np.float32))
    assert np.ptp(told, axis=1).max() == 0
    assert np.abs(told).max() <= 0.5
