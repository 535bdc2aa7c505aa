"""The scene that speed is measured on: the figures that its module states."""

import numpy as np

from voltcam_server.bench.scene import moving, noisy, patch

from .test_cli import events_of


def test_the_scene_is_the_one_that_others_were_measured_on() -> None:
    frames = moving(20, 346, 260)
    assert frames.shape == (20, 260, 346)
    assert 0.84 < (frames[1:] != frames[:-1]).mean() < 0.89
    assert 0.17 < events_of(frames, 4167) / frames[1:].size < 0.22


def test_the_webcam_has_noise_of_two_grey_levels() -> None:
    frames = noisy(50, 64, 48).astype(float)
    inside = (frames.mean(axis=0) > 20) & (frames.mean(axis=0) < 235)
    assert abs(frames.std(axis=0)[inside].mean() - 2) < 0.1


def test_it_is_the_same_each_time_and_one_patch_stands_still() -> None:
    frames = moving(3, 120, 90)
    assert frames.dtype == np.uint8
    np.testing.assert_array_equal(moving(3, 120, 90), frames)
    still = frames[:, 62:84, 80:100]  # of the static patch
    assert (still == still[0]).all()


def test_a_patch_is_a_view_of_a_third_of_the_height() -> None:
    image = np.zeros((90, 120), np.float32)
    patch(image, 0.1, 0.5)[:] = 1
    assert image.sum() == 30 * 30
    assert image[9:39, 60:90].all()
