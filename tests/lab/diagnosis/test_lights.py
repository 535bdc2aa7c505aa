"""Light that frames may have been taken of."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.lights import LIGHTS, light_behind
from voltcam_lab.scene import scene_of


def frames(dtype: type = np.uint8) -> tuple[np.ndarray, np.ndarray]:
    t_us = np.arange(20) * 10_000
    level = 100 + 60 * np.sin(t_us * 1e-6 * 2 * np.pi * 4)
    images = np.tile(level[:, None, None], (1, 8, 8))
    images[:, :, :4] = 42
    return images.astype(dtype), t_us


@pytest.mark.parametrize("version", range(len(LIGHTS)))
def test_at_each_frame_it_rounds_to_the_frame(version: int) -> None:
    taken, t_us = frames()
    shown = {t: image for image, t in light_behind(scene_of(taken, t_us, "cubic"), version)}
    for image, t in zip(taken, t_us.tolist(), strict=True):
        assert np.abs(shown[t] - image).max() <= 0.5


def test_light_that_stands_still_does() -> None:
    taken, t_us = frames()
    shown = np.stack([image for image, _ in light_behind(scene_of(taken, t_us, "cubic"), 0)])
    assert np.ptp(shown[:, :, :4], axis=0).max() < 1e-4
    assert np.ptp(shown[0, :, :4]) > 0.5  # each pixel has its own, within the level


def test_fine_frames_are_not_rounded() -> None:
    taken, t_us = frames(np.float32)
    shown = {t: image for image, t in light_behind(scene_of(taken, t_us, "cubic"), 0)}
    assert shown[0] == pytest.approx(taken[0], abs=1e-4)
