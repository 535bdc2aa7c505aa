"""Where light stands still, against looking at every window of time one by one."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_lab.calibration.intervals import INTERVAL
from voltcam_lab.light.scene import scene_of
from voltcam_lab.light.still import (
    BUCKET_LIMIT,
    BUCKET_US,
    BUCKETS_AFTER,
    BUCKETS_BEFORE,
    still_intervals,
    still_pairs,
    still_steps,
)


def test_light_that_changes_is_not_still_next_to_it_nor_a_tenth_of_a_second_about_it() -> None:
    """A square jumps from 60 to 160 DN between frames 20 and 21, 10 ms apart."""
    images = np.full((40, 30, 30), 60, np.uint8)
    images[21:, 13:17, 13:17] = 160
    still = still_pairs(images, np.arange(40) * 10_000)
    jumped = ~still[:, 15, 15]
    assert np.flatnonzero(jumped).tolist() == list(range(10, 31))
    assert still[:, 2, 2].all()
    assert not still[20, 11, 11]  # two pixels from it
    assert (still[20] == still[20].T).all()


def test_noise_of_single_frames_is_still() -> None:
    """sd 3 DN at 60: .013 of ln(L + 20) when blurred, of which 21 frames span less than .12."""
    noisy = np.rint(np.random.default_rng(1).normal(60, 3, (30, 20, 20))).astype(np.uint8)
    assert still_pairs(noisy, np.arange(30) * 10_000).mean() > 0.99


paths = st.lists(
    st.tuples(st.integers(1, 30_000), st.sampled_from([0.0, 0.0, 0.0, 0.02, -0.03, 0.2])), min_size=1
)


@settings(deadline=None)
@given(paths)
def test_steps_are_still_whose_buckets_and_those_about_them_are(path: list[tuple[int, float]]) -> None:
    t_us = np.cumsum([0, *(span for span, _ in path)])
    log = np.cumsum([5.0, *(change for _, change in path)]).astype(np.float32)
    touched = [range(int(a // BUCKET_US), int(b // BUCKET_US) + 1) for a, b in pairwise(t_us)]
    wanted = []
    for step in range(len(path)):
        near = range(
            int(t_us[step] // BUCKET_US) - BUCKETS_BEFORE,
            int(t_us[step + 1] // BUCKET_US) + BUCKETS_AFTER + 1,
        )
        seen = [log[[k, k + 1]] for k, buckets in enumerate(touched) if set(buckets) & set(near)]
        wanted.append(bool(np.ptp(seen) < BUCKET_LIMIT))
    assert still_steps(log[None], t_us)[0].tolist() == wanted


def interval(start_us: float, end_us: float, pixel: int, before: float, after: float) -> np.ndarray:
    one = np.zeros(1, INTERVAL)
    one["start_us"], one["end_us"], one["pixel"] = start_us, end_us, pixel
    one["before"], one["after"] = before, after
    return one


@pytest.mark.parametrize(
    ("start_ms", "pixel", "levels", "still"),
    [
        (300, 0, (100, 100), True),
        (300, 0, (100, 103), True),  # 2.5 %
        (300, 0, (100, 105), False),  # 4.1 %
        (300, 1, (100, 100), False),  # it jumps at 340 ms
        (200, 1, (100, 100), True),
        (300, 2, (1, 1), False),  # black
        (300, 3, (250, 250), False),  # as bright as it gets
    ],
)
def test_intervals_are_still_whose_surroundings_are(
    start_ms: float, pixel: int, levels: tuple[float, float], still: bool
) -> None:
    """Of 10 ms; light 50 ms before and after counts."""
    t_us = np.arange(0, 600_001, 10_000)
    images = np.tile(np.array([100, 100, 1, 250], np.float32), (len(t_us), 1))
    images[t_us >= 340_000, 1] = 150
    scene = scene_of(images[:, None, :], t_us, "linear")
    one = interval(1000 * start_ms, 1000 * start_ms + 10_000, pixel, *levels)
    assert still_intervals(scene, one).tolist() == [still]
