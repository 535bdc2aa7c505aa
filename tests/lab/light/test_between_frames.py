"""Which light is taken between frames."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from voltcam_lab.light.between_frames import (
    calm,
    calmed,
    evened,
    frame_noise2,
    scene_between,
    sharpened,
    untrusted_share,
)
from voltcam_lab.light.scene import Scene, scene_of

PERIOD_US, SIDE = 10_000, 32


def waves(pixels_a_frame: float, frames: int = 24) -> np.ndarray:
    """Texture of 5 pixels' wavelength that goes to the right."""
    y, x = np.mgrid[:SIDE, :SIDE]
    moved = [x - pixels_a_frame * k for k in range(frames)]
    light = [110 + 45 * np.sin(2 * np.pi * x / 9) + 45 * np.sin(2 * np.pi * (x + y) / 7) for x in moved]
    return np.rint(light).astype(np.uint8)


def between(frames: np.ndarray, *arguments: object) -> Scene:
    return scene_between(frames, PERIOD_US * np.arange(len(frames)), *arguments)  # type: ignore[arg-type]


def test_waves_of_many_frames_go_along_a_spline() -> None:
    assert between(waves(0.4)).how == "spline"


def test_light_that_jumps_goes_along_a_monotone_curve() -> None:
    """A spline would swing before and after each jump."""
    rng = np.random.default_rng(1)
    steps = rng.integers(0, 2, (24, 1, 1)) * (rng.random((SIDE, SIDE)) < 0.004)
    frames = (60 + 120 * np.repeat(steps, 4, axis=0)).astype(np.uint8)
    assert between(frames).how == "cubic"


def test_of_fast_light_that_with_less_doubt_is_taken() -> None:
    """Doubt of the caller's own: here, of one way or of the other."""
    frames = waves(2.0)
    assert between(frames).trusted().mean() < 0.9
    for wanted in ("spline", "cubic", "auto"):
        assert between(frames, None, lambda scene, wanted=wanted: float(scene.how != wanted)).how == wanted


def test_columns_are_those_of_the_whole() -> None:
    """Motion is seen in whole frames, and the surprise is theirs."""
    frames, columns = waves(2.0), np.array([3, 4, 5, 20, 21])
    whole = between(frames, None, untrusted_share)
    part = between(frames, columns, lambda scene: float(scene.how != whole.how))
    assert part.how == whole.how
    np.testing.assert_array_equal(part.images, whole.images[:, :, columns])
    np.testing.assert_array_equal(part.taken, frames[:, :, columns])
    surprise = whole.surprise.reshape(frames.shape)[:, :, columns]
    np.testing.assert_array_equal(part.surprise.reshape(surprise.shape), surprise)


def test_noise_is_calmed_where_nothing_moves() -> None:
    rng = np.random.default_rng(0)
    frames = np.full((20, 40, 60), 100.0)
    frames[:, :, 30:] += 20 * np.sin(np.arange(30) - np.arange(20)[:, None, None])
    noisy = frames + rng.normal(0, 1, frames.shape)
    found = calmed(scene_of(noisy.astype(np.float32), np.arange(20) * 10_000, "linear")).taken
    assert np.std((found - frames)[5:15, :, :20]) < 0.6
    assert np.abs(found - noisy)[5:15, :, 35:].max() < 0.1


def test_images_between_frames_are_as_sharp_as_the_others() -> None:
    rng = np.random.default_rng(1)
    sharp = (60 + 40 * rng.random((3, 40, 40))).astype(np.float32)
    blurred = np.mean([np.roll(sharp, (dy, dx), (1, 2)) for dy in (0, 1) for dx in (0, 1)], axis=0)
    images = np.stack([sharp[0], blurred[0], sharp[1], blurred[1], sharp[2]]).astype(np.float32)
    taken_us = np.array([0, 20_000, 40_000])
    scene = Scene(sharp, taken_us, images, np.arange(5) * 10_000)
    before, after = (np.abs(np.diff(each, axis=2)).mean((1, 2)) for each in (images, evened(scene).images))
    assert np.ptp(before) > 0.3 * before.mean()
    assert np.ptp(after) < 0.1 * after.mean()


def textured(blurs: list[float]) -> Scene:
    """A frame each 20 ms and an image between two, all of one texture; blurs: sd of each one's [pixels]."""
    texture = 60 + 40 * np.random.default_rng(4).random((40, 40))
    images = np.stack([gaussian_filter(texture, blur) for blur in blurs]).astype(np.float32)
    t_us = 10_000 * np.arange(len(blurs))
    return Scene(images[::2], t_us[::2], images, t_us)


def fineness(images: np.ndarray) -> np.ndarray:
    return np.asarray(np.abs(np.diff(images, axis=2)).mean((1, 2)))


def test_images_are_blurred_only_near_those_that_are_blurred() -> None:
    """Of 16 gaps the last 8 have a blurred image between their frames."""
    scene = textured([0.0] * 16 + [0.0, 0.5] * 8 + [0.0])
    found = evened(scene)
    np.testing.assert_array_equal(found.images[:9], scene.images[:9])
    np.testing.assert_array_equal(found.taken, scene.taken)
    sharp, blurred = fineness(scene.images)[:2], fineness(found.images[24:])
    assert blurred == pytest.approx(np.full(9, blurred[1]), rel=0.1)
    assert blurred.max() < 0.7 * sharp[0]


def test_a_frame_that_is_blurred_itself_blurs_the_light_beside_it() -> None:
    found = fineness(evened(textured([0.0, 0.0, 0.5, 0.0, 0.0])).images)
    assert found == pytest.approx(np.full(5, found[2]), rel=0.1)


def test_a_blur_that_takes_some_percent_of_the_structure_is_evened() -> None:
    """As little as that shows once a frame in simulated events."""
    scene = textured([0.0, 0.3, 0.0, 0.3, 0.0])
    before, after = fineness(scene.images), fineness(evened(scene).images)
    assert 0.92 < before[1] / before[0] < 0.99
    assert after == pytest.approx(np.full(5, before[1]), rel=0.01)


def test_sharpening_is_undone_by_its_blur() -> None:
    """Light is never below 0; flat light stays as it is."""
    flat = np.full((2, 8, 8), 7.0, np.float32)
    scene = Scene(flat, np.array([0, 10]), flat, np.array([0, 10]))
    assert (sharpened(scene, 0.5).images == flat).all()
    edge = replace(scene, images=np.where(np.arange(8) < 4, 0, 200) * np.ones_like(flat))
    assert sharpened(edge, 0.5).images.min() == 0
    assert sharpened(edge, 0.5).images.max() > 200


@pytest.mark.parametrize(("sd", "rise"), [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.0, 0.6), (0.3, 0.6)])
def test_noise_of_frames_is_its_variance_less_the_square_of_a_steady_rise(sd: float, rise: float) -> None:
    """Of 38 000 products the mean is known to 2 % of the noise; five times that is allowed."""
    rng = np.random.default_rng(2)
    frames = 80 + rise * np.arange(40)[:, None, None] + sd * rng.normal(0, 1, (40, 30, 35))
    assert frame_noise2(frames) == pytest.approx(max(sd**2 - rise**2, 0), abs=0.1 * sd**2 + 1e-6)


def test_calm_frames_are_means_over_the_longest_span_that_differs_by_no_more_than_noise() -> None:
    """At rest noise goes down to that of the mean of 45; where light jumps frames stay as they were."""
    rng = np.random.default_rng(3)
    light = np.full((90, 16, 24), 100.0)
    light[45:, :, 12:] = 160
    noisy = light + rng.normal(0, 1, light.shape)
    found = calm(noisy, 1.0, (5, 15, 45))
    assert np.std((found - light)[30:60, :, :6]) < 2 / np.sqrt(45)
    assert np.abs(found - noisy)[43:47, :, 15:].max() < 0.1
