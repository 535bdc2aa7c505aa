"""A scene simulated where and when it is looked at only."""

import numpy as np
import pytest
from tests.lab.calibration.refine.made import (
    START,
    wave,
)

from voltcam_lab.calibration.refine.replay import WARM_UP_US, Replay
from voltcam_lab.distances import Region
from voltcam_lab.light.scene import Scene
from voltcam_lab.models.model import MODELS, simulate

QUIET = START.changed(
    {
        "photon_noise": {"k3": 0.0},
        "leak_noise": {"k6": 1e-9},
        "threshold_mismatch": {"sigma": 0.0},
        "reset_noise": {"sigma": 0.0},
    }
)


def test_pixels_keep_their_places() -> None:
    """A ragged region: rows with few pixels, many, and none."""
    scene, rng = wave(), np.random.default_rng(1)
    pixels = rng.random((24, 24)) < rng.uniform(0, 1, (24, 1))
    pixels[5] = False
    replay = Replay.of(scene, Region.whole(24, 24, 0, 400_000).on(pixels))
    assert replay.x.shape[1] == pixels.sum(axis=1).max()
    for y, row in enumerate(replay.x):
        used = row[row >= 0]
        assert used.tolist() == np.flatnonzero(pixels[y]).tolist()
        np.testing.assert_array_equal(replay.images[:, y, : len(used)], scene.images[:, y, used])


def test_it_gives_what_the_whole_sensor_gives_at_the_region_s_pixels() -> None:
    """Without noise no random number is left but the voltage each pixel starts at: rates to 4 %."""
    scene = wave()
    pixels = np.indices((24, 24)).sum(axis=0) // 6 % 2 == 0
    region = Region.whole(24, 24, 0, 400_000).on(pixels)
    some = Replay.of(scene, region).events(QUIET, 1)
    everything = region.of(simulate(MODELS["exact"](24, 24, QUIET, 1), scene))
    assert pixels[some["y"], some["x"]].all()
    assert (np.diff(some["t"]) >= 0).all()
    assert some.size == pytest.approx(everything.size, rel=0.04)


def test_between_stretches_there_are_only_the_frames_that_were_taken() -> None:
    taken_us = np.arange(0, 1_000_001, 100_000)
    t_us = np.arange(0, 1_000_001, 10_000)
    images = np.zeros((len(t_us), 2, 2), np.float32)
    scene = Scene(images[::10], taken_us, images, t_us)
    region = Region.whole(2, 2, 0, 1_000_000).during(np.array([[200_000, 250_000], [700_000, 730_000]]))
    wanted = [
        t
        for t in t_us.tolist()
        if 200_000 - WARM_UP_US <= t <= 250_000
        or 700_000 - WARM_UP_US <= t <= 730_000
        or (t % 100_000 == 0 and 150_000 <= t <= 730_000)
    ]
    assert Replay.of(scene, region).t_us.tolist() == wanted
