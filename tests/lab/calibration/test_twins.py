"""Twins: light like the recording's, its frames taken anew, and the errors they show."""

from dataclasses import replace

import numpy as np
import pytest

from voltcam_lab.calibration.fit import NAMES, fit
from voltcam_lab.calibration.reading import Reading
from voltcam_lab.calibration.twins import retake, twin, unbiased
from voltcam_lab.light.between_frames import scene_between
from voltcam_lab.light.scene import Scene
from voltcam_simulator import Parameters

PERIOD_US = 10_000


def waves(frames: int = 60) -> Scene:
    y, x = np.mgrid[:12, :16]
    t = np.arange(frames)[:, None, None]
    light = 100 + 50 * np.sin((x + 0.5 * y - 0.3 * t) / 3) * (x > 4)
    return scene_between(np.rint(light).astype(np.uint8), PERIOD_US * np.arange(frames, dtype=np.int64))


def test_frames_taken_anew_are_roundings_of_the_new_light() -> None:
    scene = waves()
    retaken = retake(scene, np.random.default_rng(1), bend_error=0.2)
    times = np.array([t_us for _, t_us in retaken.light])
    light = np.stack([image for image, _ in retaken.light])
    assert len(retaken.scene.taken) in (len(scene.taken), len(scene.taken) - 1)
    for frame, t_us in zip(retaken.scene.taken, retaken.scene.taken_us, strict=True):
        k = int(np.clip(np.searchsorted(times, t_us), 1, len(times) - 1))
        share = (t_us - times[k - 1]) / (times[k] - times[k - 1])
        assert np.abs(frame - (light[k - 1] + share * (light[k] - light[k - 1]))).max() <= 0.501
    assert retaken.scene.taken.dtype == np.uint8


def test_the_new_light_is_as_bright_and_as_lively() -> None:
    scene = waves()
    retaken = retake(scene, np.random.default_rng(2), bend_error=0.0)
    mine, other = scene.taken.astype(float), retaken.scene.taken.astype(float)
    assert abs(mine.mean() - other.mean()) < 1
    assert abs(np.abs(np.diff(mine, axis=0)).mean() / np.abs(np.diff(other, axis=0)).mean() - 1) < 0.05
    assert (mine[: len(other)] != other).mean() > 0.3  # not the frames of the recording again


def test_light_at_rest_stays_at_rest() -> None:
    retaken = retake(waves(), np.random.default_rng(3), bend_error=0.5)
    assert np.ptp(np.stack([image[:, :3] for image, _ in retaken.light]), axis=0).max() < 1e-3


def test_events_begin_with_the_frames_and_repeat_with_the_seed() -> None:
    retaken = retake(waves(), np.random.default_rng(4), bend_error=0.0)
    first, again, other = (twin(retaken, Parameters.of("paper"), seed) for seed in (5, 5, 6))
    assert first["t"].min() >= retaken.scene.t_us[0]
    assert (first == again).all()
    assert len(first) > 500
    assert len(first) != len(other) or (first != other).any()


def test_what_is_rounded_alike_is_off_alike() -> None:
    """Pixels of one grey level that stay at rest have one light in a twin, and it is another."""
    retaken = retake(waves(), np.random.default_rng(6), bend_error=0.0)
    still = retaken.light[0][0][:, :3]
    assert np.ptp(still) == 0
    assert still[0, 0] != 100


def test_twins_move_nothing_that_the_data_do_not_fix() -> None:
    scene = waves(120)
    events = twin(retake(scene, np.random.default_rng(1), 0.0), Parameters.of("paper"), 1)
    reading = Reading(events, scene, np.ones((12, 16), np.bool_), np.zeros((0, 2), np.int64))
    found = fit(reading.intervals(0.0, 0.0), 0.0, 16)
    steps: list[str] = []
    for informed in (np.zeros_like(found.informed), found.informed):
        log, _ = unbiased(reading, replace(found, informed=informed), 0.0, 0.0, 1, steps.append)
        apart = {name: abs(log[i] - found.log[i]) for i, name in enumerate(NAMES)}
        kept = all(
            apart[name] == pytest.approx(0, abs=1e-9) for name in ("k1", "k2_dn", "noise", "on_over_off")
        )
        assert kept == (not informed.any())
    assert len(steps) == 32
