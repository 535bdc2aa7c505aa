import numpy as np
import pytest

from voltcam_video.photos import PlaneMotion, displaced

WIDTH, HEIGHT = 120, 90


def motion(seed: int, speed_px_s: float = 100.0, reach: float = 0.2) -> PlaneMotion:
    return PlaneMotion(WIDTH, HEIGHT, np.random.default_rng(seed), speed_px_s=speed_px_s, reach=reach)


def test_the_derivative_is_that_of_the_homography() -> None:
    step_us = 100.0
    for seed in range(20):
        plane = motion(seed)
        difference = (plane.at(7e5 + step_us)[0] - plane.at(7e5 - step_us)[0]) / (2 * step_us * 1e-6)
        np.testing.assert_allclose(plane.at(7e5)[1], difference, rtol=1e-5, atol=1e-6)


def test_speed_and_reach_are_root_mean_squares() -> None:
    # over many turns of three sines each; 40 planes: r.m.s. to a few per cent
    times_us = np.linspace(0, 4e8, 400)
    at = [[plane.at(t_us) for t_us in times_us] for plane in map(motion, range(40))]
    middle = np.array([[matrix[:2, 2] for matrix, _ in each] for each in at])
    speed = np.array([[change[:2, 2] for _, change in each] for each in at])
    assert np.sqrt(np.mean(np.sum(speed**2, axis=-1))) == pytest.approx(100, rel=0.05)
    way = np.sqrt(np.mean((middle - [(WIDTH - 1) / 2, (HEIGHT - 1) / 2]) ** 2, axis=(0, 1)))
    np.testing.assert_allclose(way, [0.2 * WIDTH, 0.2 * HEIGHT], rtol=0.05)


def test_twice_the_speed_is_the_same_way_in_half_the_time() -> None:
    np.testing.assert_allclose(motion(1).at(2e6)[0], motion(1, speed_px_s=200).at(1e6)[0], rtol=1e-12)


def test_what_is_seen_lies_in_front_of_the_camera() -> None:
    x, y = np.meshgrid([0.0, WIDTH - 1], [0.0, HEIGHT - 1])
    for seed in range(50):
        for t_us in np.linspace(0, 2e7, 50):
            matrix = motion(seed, reach=0.35).at(t_us)[0]
            back = displaced(x, y, np.linalg.inv(matrix))
            assert (matrix[2, 0] * back[0] + matrix[2, 1] * back[1] + 1 > 0.3).all()


def test_points_go_where_the_matrix_takes_them() -> None:
    matrix = np.array([[2.0, 0, 1], [0, 3, 2], [0.5, 0, 1]])
    x, y = displaced(np.array([2.0]), np.array([1.0]), matrix)
    assert (x.item(), y.item()) == (5 / 2, 5 / 2)
