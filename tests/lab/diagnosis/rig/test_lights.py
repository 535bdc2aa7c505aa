"""Light that frames may have been taken of."""

import numpy as np
import pytest

from voltcam_lab.diagnosis.rig.lights import light_behind
from voltcam_lab.diagnosis.rig.settings import DEFAULT_RIG
from voltcam_lab.light.scene import How, scene_of


def frames() -> tuple[np.ndarray, np.ndarray]:
    t_us = np.arange(20) * 10_000
    level = 100 + 60 * np.sin(t_us * 1e-6 * 2 * np.pi * 20)
    images = np.tile(level[:, None, None], (1, 8, 8))
    images[:, :, :4] = 42
    return images.astype(np.float32), t_us


@pytest.mark.parametrize("how", ["spline", "cubic", "auto"])
@pytest.mark.parametrize("version", range(len(DEFAULT_RIG.lights)))
def test_at_each_frame_it_is_the_frame(version: int, how: How) -> None:
    taken, t_us = frames()
    shown = {t: image for image, t in light_behind(scene_of(taken, t_us, how), version, DEFAULT_RIG)}
    for image, t in zip(taken, t_us.tolist(), strict=True):
        assert shown[t] == pytest.approx(image, abs=1e-3)


def test_versions_differ_where_light_moves_and_only_there() -> None:
    taken, t_us = frames()
    scene = scene_of(taken, t_us, "spline")
    first, second = (np.stack([image for image, _ in light_behind(scene, k, DEFAULT_RIG)]) for k in (0, 1))
    assert first[:, :, :4] == pytest.approx(np.full_like(first[:, :, :4], 42), abs=1e-3)
    assert second[:, :, :4] == pytest.approx(np.full_like(first[:, :, :4], 42), abs=1e-3)
    assert np.abs(first - second)[:, :, 4:].max() > 1


def test_what_rounding_hides_is_in_each_version_and_in_none_on_average() -> None:
    taken, t_us = frames()
    rounding = np.random.default_rng(1).uniform(-0.4, 0.4, (2, *taken.shape)).astype(np.float16)
    scene = scene_of(taken, t_us, "spline")
    told = scene.with_rounding(rounding)
    versions = []
    for k in range(4):
        shown = {t: image for image, t in light_behind(told, k, DEFAULT_RIG)}
        versions.append(np.stack([shown[t] for t in t_us.tolist()]) - taken)
    assert versions[0] == pytest.approx(rounding[0], abs=2e-3)
    assert versions[2] == pytest.approx(rounding[1], abs=2e-3)
    assert np.mean(versions, axis=0) == pytest.approx(np.zeros_like(taken), abs=1e-3)
