"""The ends of a frame's scale, on frames of sensors that are made to saturate."""

import numpy as np
import pytest

from voltcam_lab.light.scale import is_black, is_white, white_dn
from voltcam_lab.light.scene import scene_of

RNG = np.random.default_rng(5)
WIDTH, HEIGHT, FRAMES = 48, 32, 60


def panorama(lowest: float, highest: float) -> np.ndarray:
    """Light (FRAMES, HEIGHT, WIDTH) of soft stripes that go by, from one grey level to another."""
    x = np.arange(WIDTH)[None, None, :] + 1.7 * np.arange(FRAMES)[:, None, None]
    y = np.arange(HEIGHT)[None, :, None]
    wave = np.sin(x / 5) + np.sin(y / 4 + x / 11)
    return lowest + (highest - lowest) * (wave + 2) / 4


def taken(light: np.ndarray, white: np.ndarray | float, noise_dn: float = 1.5) -> np.ndarray:
    """Frames of it: noise comes before a pixel is full."""
    noisy = light + RNG.normal(0, noise_dn, light.shape)
    return np.rint(np.clip(noisy, 0, white)).astype(np.uint8)


@pytest.mark.parametrize("full", [90.0, 114.0, 200.0])
def test_white_is_where_the_brightest_levels_stay_as_they_are(full: float) -> None:
    """Each pixel is full at its own level, 2.5 DN about one. Half of them are below it."""
    own = full + RNG.normal(0, 2.5, (HEIGHT, WIDTH))
    found = white_dn(taken(panorama(10, 1.5 * full), own))
    assert full - 8 < found < full + 1


@pytest.mark.parametrize("noise_dn", [1.0, 2.0])
def test_frames_that_reach_no_end_have_the_usual_white(noise_dn: float) -> None:
    assert white_dn(taken(panorama(10, 180), 255, noise_dn)) == 255


@pytest.mark.parametrize("noise_dn", [1.0, 2.0])
def test_a_bright_wall_at_rest_is_no_white(noise_dn: float) -> None:
    """It has noise, though all that is darker moves."""
    light = panorama(10, 120)
    light[:, :12] = 180.0
    assert white_dn(taken(light, 255, noise_dn)) == 255


def test_a_still_picture_without_noise_tells_nothing_of_white() -> None:
    picture = np.broadcast_to(panorama(10, 180)[0], (FRAMES, HEIGHT, WIDTH))
    assert white_dn(taken(picture, 255, 0.0)) == 255


def test_light_that_is_no_whole_number_has_the_usual_white() -> None:
    assert white_dn(panorama(10, 180)) == 255
    assert white_dn(taken(panorama(10, 180), 100)[:1]) == 255


def test_levels_at_an_end() -> None:
    levels = np.array([0, 1, 113, 114, 200])
    assert is_black(levels).tolist() == [True, False, False, False, False]
    assert is_white(levels, 114).tolist() == [False, False, False, True, True]
    assert not is_white(levels / 1.0, 255).any()
    assert not is_white(np.array([1.0, 255, 3000.0]), 255).any()  # another scale


def test_light_is_not_known_where_a_frame_is_black_or_white() -> None:
    """A pixel is black in the third frame, another in three, one white in the first."""
    frames = np.full((6, 4, 4), 60, np.uint8)
    frames[2, 1, 1], frames[1:4, 2, 0], frames[0, 3, 3] = 0, 0, 255
    scene = scene_of(frames, 5000 * np.arange(6, dtype=np.int64), "linear")
    scene.__dict__["surprise"] = np.zeros((6, 16), np.float32)
    known = scene.known().gaps.reshape(5, 4, 4)
    assert known[:, 1, 1].tolist() == [True, False, False, True, True]
    assert known[:, 2, 0].tolist() == [False, False, False, False, True]
    assert known[:, 3, 3].tolist() == [False, True, True, True, True]
    assert known.sum() == 5 * 16 - 7
    black = scene.black().gaps.reshape(5, 4, 4)
    assert black.sum() == 6
    np.testing.assert_array_equal(black[:, 1:3], ~known[:, 1:3])
    assert np.argwhere(scene.white().gaps).tolist() == [[0, 15]]
