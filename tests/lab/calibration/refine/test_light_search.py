"""Which light between frames is closest, by a score that is a formula of it."""

import numpy as np
from scipy.ndimage import gaussian_filter

from voltcam_lab.calibration.refine.coordinates import Point
from voltcam_lab.calibration.refine.light_search import closest_light
from voltcam_lab.calibration.refine.replay import Replay
from voltcam_lab.distances import Region
from voltcam_lab.light.scene import Scene

from .made_search import PLAIN, MadeSearch


def test_light_that_is_blurred_between_frames_is_taken_evened_where_that_is_closer() -> None:
    """The score is how unequally fine the images are that would be simulated."""
    texture = (60 + 40 * np.random.default_rng(2).random((40, 40))).astype(np.float32)
    images = np.stack([texture, gaussian_filter(texture, 0.5)] * 8 + [texture])
    t_us = 10_000 * np.arange(len(images))
    blurring = Scene(images[::2], t_us[::2], images, t_us)

    def unequal(_: Point) -> float:
        return float(np.ptp(np.abs(np.diff(search.replay.images, axis=2)).mean((1, 2))))

    search = MadeSearch(unequal)
    search.scene, search.region = blurring, Region.whole(40, 40, 0, int(t_us[-1]))
    search.replay = Replay.of(blurring, search.region)
    before = unequal(PLAIN)
    found = closest_light(search, PLAIN)
    assert "evened" in found.words
    assert unequal(PLAIN) == found.score < 0.2 * before
