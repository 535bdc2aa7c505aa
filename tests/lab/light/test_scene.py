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


@pytest.mark.parametrize(("between", "at_an_end"), [(0.0, "black"), (1.0, ""), (254.0, ""), (255.0, "white")])
def test_light_that_was_at_an_end_of_the_scale_between_two_frames_is_not_known(
    between: float, at_an_end: str
) -> None:
    """A dark bar, or a bright one, went by: no frame shows it at that pixel. It does at another one."""
    taken, taken_us = np.full((5, 3, 4), 100.0, np.float32), PERIOD_US * np.arange(5)
    taken[:, 2, 3] = 255
    images, t_us = np.repeat(taken, 2, axis=0)[:-1], PERIOD_US // 2 * np.arange(9)
    images[5, 1, 1] = between
    images[5, 0, 0] = 256.5  # a curve may go beyond white
    found = Scene(taken, taken_us, images, t_us, "auto")
    for name, gaps in (("black", found.black().gaps), ("white", found.white().gaps)):
        assert gaps[2, 5] == (name == at_an_end)
        assert gaps[[0, 1, 3], 5].sum() == 0
    assert found.white().gaps[2, 0]
    assert (found.trusted()[:, 5] == (np.arange(4) != 2) | (at_an_end == "")).all()


def test_doubt_is_largest_half_way_and_nothing_at_a_frame() -> None:
    images = ramp().astype(float)
    images[3, 1, 2] += 8
    found, pixel = scene(images), np.full(5, 6, np.int32)
    at = found.doubt(pixel, np.array([30_000.0, 32_500.0, 35_000.0, 37_500.0, 40_000.0]))
    assert at == pytest.approx([0, 6, 8, 6, 0], abs=1e-3)
    outside = found.doubt(pixel[:2], np.array([-5000.0, 99_000.0]))
    assert not outside.any()


def test_the_bow_is_how_far_images_leave_the_straight_line() -> None:
    taken = np.full((3, 2, 2), 100.0, np.float32)
    taken[1, 0, 1] = 140
    taken_us, t_us = np.array([0, 10_000, 20_000]), np.array([0, 2500, 5000, 10_000, 20_000])
    images = np.stack([taken[0], taken[0], taken[0], taken[1], taken[2]])
    found = Scene(taken, taken_us, images, t_us, "auto")
    assert found.bow[0] == pytest.approx([0, 20 / 120, 0, 0])  # at 5000 us 120 DN would be straight
    assert not found.bow[1].any()


def swinging(period_us: float, how: str = "spline", frames: int = 60) -> Scene:
    """Every pixel goes up and down by 40 of 100 DN, each from a phase of its own."""
    taken_us = PERIOD_US * np.arange(frames, dtype=np.int64)
    phase = np.linspace(0, 6, 400).reshape(20, 20)
    taken = 100 + 40 * np.sin(2 * np.pi * taken_us[:, None, None] / period_us + phase)
    return scene_of(taken.astype(np.float32), taken_us, how)


def test_surprise_falls_less_where_light_is_fast_against_frames() -> None:
    """The error of a cubic spline goes with the fourth power of the time between frames, or a higher one."""
    slow, faster, fast = (swinging(n * PERIOD_US).fall for n in (16, 12, 8))
    assert 0 < slow < 1 / 16
    assert 1.5 * slow < faster < 0.8 * fast < 0.8


def test_the_fall_of_surprise_is_a_usual_one_where_little_tells_it() -> None:
    still = scene_of(np.full((60, 20, 20), 100.0, np.float32), PERIOD_US * np.arange(60), "spline")
    assert still.fall == swinging(8 * PERIOD_US, frames=8).fall
    assert 1 / 16 < still.fall < 1 / 4
    assert swinging(9.5 * PERIOD_US, "auto").fall == 1


def test_light_on_a_curve_may_surprise_more_for_the_same_error() -> None:
    curve, guess = swinging(20 * PERIOD_US), swinging(20 * PERIOD_US, "auto")
    assert guess.tolerance == TRUSTED
    assert curve.tolerance == 2 * TRUSTED


def test_a_scene_out_of_step_has_its_curve_its_frames_and_its_surprise() -> None:
    for how in ("spline", "cubic"):
        scene = swinging(12 * PERIOD_US, how)
        found = scene.out_of_step()
        assert found.how == how
        assert found.taken is scene.taken
        assert found.surprise is scene.surprise
        assert not np.isin(scene.taken_us[1:-1], found.t_us).all()
        at = np.searchsorted(found.t_us, 300_000, side="right") - 1
        share = (300_000 - found.t_us[at]) / (found.t_us[at + 1] - found.t_us[at])
        met = (1 - share) * found.images[at] + share * found.images[at + 1]
        np.testing.assert_allclose(met, scene.taken[30], rtol=0.01)
