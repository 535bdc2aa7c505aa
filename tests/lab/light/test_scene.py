"""Scenes whose light is known: what is between frames, and how far one may trust it."""

import numpy as np
import pytest

from voltcam_lab.light.scene import TRUSTED, Scene, scene_of

PERIOD_US = 10_000


def scene(images: np.ndarray, *t_us: int) -> Scene:
    times = np.array(t_us or PERIOD_US * np.arange(len(images)), np.int64)
    return scene_of(images.astype(np.float32), times, "linear")


def ramp(frames: int = 7) -> np.ndarray:
    """(frames, 3, 4), pixels that rise at speeds of their own."""
    return 100 + np.arange(frames)[:, None, None] * np.arange(12).reshape(3, 4)


def test_frames_are_all_there_at_their_times() -> None:
    images = np.random.default_rng(1).uniform(0, 255, (5, 3, 4))
    found = scene(images, 0, 10_000, 15_000, 40_000, 50_000)
    assert (found.height, found.width) == (3, 4)
    given = {frame.t_us: frame.image for frame in found.frames()}
    for image, t_us in zip(found.taken, found.taken_us.tolist(), strict=True):
        np.testing.assert_array_equal(given[t_us], image)
    assert sorted(given) == list(given)


def test_light_on_a_straight_line_surprises_nobody() -> None:
    found = scene(ramp())
    assert found.surprise == pytest.approx(0, abs=1e-4)
    assert found.trusted().all()
    assert found.trusted().shape == (6, 12)
    assert not scene(ramp()).doubt(np.array([3], np.int32), np.array([25_000.0])).any()


def test_a_surprise_is_the_distance_from_the_line_between_the_neighbours() -> None:
    """The first frame and the last have a neighbour on one side only: they never surprise."""
    images = np.random.default_rng(2).uniform(0, 255, (7, 3, 4)).astype(np.float32)
    t_us = np.array([0, 10, 25, 30, 50, 55, 70]) * 1000
    found = scene(images, *t_us.tolist())
    for k in range(1, 6):
        share = (t_us[k] - t_us[k - 1]) / (t_us[k + 1] - t_us[k - 1])
        line = (1 - share) * images[k - 1] + share * images[k + 1]
        assert found.surprise[k] == pytest.approx(np.abs(images[k] - line).ravel(), abs=1e-3)
    assert not found.surprise[[0, -1]].any()


def test_where_a_frame_surprises_its_neighbourhood_is_not_trusted_before_and_after() -> None:
    images = np.full((9, 6, 8), 100.0)
    images[4, 2, 3] += 2.1 * TRUSTED * 120  # its neighbours in time are off by half of that
    trusted = scene(images).trusted().reshape(8, 6, 8)
    wanted = np.ones((8, 6, 8), bool)
    wanted[2:6, 1:4, 2:5] = False
    assert (trusted == wanted).all()
    assert scene(images).trusted(0.2).all()


@pytest.mark.parametrize(("brightest", "trusted"), [(255, False), (254, True), (300, True)])
def test_how_bright_white_is_frames_do_not_tell(brightest: int, trusted: bool) -> None:
    """Unless they have brighter pixels."""
    images = np.full((9, 6, 8), 100.0)
    images[:, 2, 3], images[:, 5, 5] = min(brightest, 255), brightest
    found = scene(images).trusted().reshape(8, 6, 8)
    assert (found[:, 2, 3] == trusted).all()
    assert found[:, 2, 4].all()


def test_doubt_is_largest_half_way_and_nothing_at_a_frame() -> None:
    images = ramp().astype(float)
    images[3, 1, 2] += 8
    found, pixel = scene(images), np.full(5, 6, np.int32)
    at = found.doubt(pixel, np.array([30_000.0, 32_500.0, 35_000.0, 37_500.0, 40_000.0]))
    assert at == pytest.approx([0, 6, 8, 6, 0], abs=1e-3)
    outside = found.doubt(pixel[:2], np.array([-5000.0, 99_000.0]))
    assert not outside.any()


def swaying(pixels: int) -> Scene:
    """Of 10 000 pixels so many go up and down by 40 of 100 DN, by 1.2 radians from frame to frame."""
    taken_us = 4000 * np.arange(30, dtype=np.int64)
    taken = np.full((30, 10_000), 100.0)
    taken[:, :pixels] += 40 * np.sin(taken_us[:, None] * 3e-4 + np.linspace(0, 6, pixels))
    return scene_of(taken.reshape(30, 100, 100).astype(np.float32), taken_us, "cubic")


def test_coarser_light_has_one_image_between_frames_in_the_middle() -> None:
    scene = swaying(90)  # less than a hundredth
    coarse = scene.coarser()
    assert np.isin(scene.taken_us, coarse.t_us).all()
    assert set(np.diff(scene.t_us)) == {1000}
    assert set(np.diff(coarse.t_us)) == {2000}
    assert coarse.images == pytest.approx(scene.images[np.isin(scene.t_us, coarse.t_us)])
    assert coarse.surprise is scene.surprise


def test_light_that_chords_would_miss_stays_as_it_is() -> None:
    """In the middle of a chord of 2 ms it misses 40 DN by (1 - cos 0.3), 1.8 DN."""
    assert set(np.diff(swaying(10_000).coarser().t_us)) == {1000}


def test_light_that_is_straight_stays_so_when_it_is_made_coarser() -> None:
    taken_us = 4000 * np.arange(6, dtype=np.int64)
    scene = scene_of(np.full((6, 2, 3), 50, np.uint8), taken_us, "spline")
    assert scene.coarser().t_us.tolist() == taken_us.tolist()


def test_the_bow_is_how_far_images_leave_the_straight_line() -> None:
    taken = np.full((3, 2, 2), 100.0, np.float32)
    taken[1, 0, 1] = 140
    taken_us, t_us = np.array([0, 10_000, 20_000]), np.array([0, 2500, 5000, 10_000, 20_000])
    images = np.stack([taken[0], taken[0], taken[0], taken[1], taken[2]])
    found = Scene(taken, taken_us, images, t_us, "auto")
    assert found.bow[0] == pytest.approx([0, 20 / 120, 0, 0])  # at 5000 us 120 DN would be straight
    assert not found.bow[1].any()
