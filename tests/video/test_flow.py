"""Frames along the motion, on scenes whose every instant is known."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_video import Frame, Image
from voltcam_video.upsample import Upsampling, between

Plane = NDArray[Any]
Scene = Callable[[float], Plane]  # of the time 0..1 between two frames; (H, W) in 0..255

WIDTH, HEIGHT = 346, 260
Y, X = np.mgrid[:HEIGHT, :WIDTH].astype(np.float64)
SPAN_US = 33_333


def texture(seed: int, amplitude: float) -> Callable[[Plane, Plane], Plane]:
    """Plane waves of 8 to 200 pixels, as strong in each octave as in natural images: known at any place."""
    rng = np.random.default_rng(seed)
    number, turn = 2 * np.pi / np.geomspace(8, 200, 40), rng.uniform(0, 2 * np.pi, 40)
    waves = list(zip(number * np.cos(turn), number * np.sin(turn), rng.uniform(0, 7, 40), strict=True))

    def at(x: Plane, y: Plane) -> Plane:
        return 120 + amplitude * sum(
            (np.sin(p * x + q * y + phase) for p, q, phase in waves), np.zeros_like(x)
        )

    return at


GROUND, OBJECT = texture(1, 9), texture(2, 8)


def moving(vx: float, vy: float) -> Scene:
    return lambda t: GROUND(X - vx * t, Y - vy * t)


def turning(t: float) -> Plane:
    """3 degrees about the centre: 10 pixels in the corners."""
    cosine, sine = np.cos(np.deg2rad(3 * t)), np.sin(np.deg2rad(3 * t))
    x, y = X - WIDTH / 2, Y - HEIGHT / 2
    return GROUND(cosine * x + sine * y, cosine * y - sine * x)


def covering(t: float) -> Plane:
    """A textured disc of 45 pixels radius goes 14.6 pixels over a ground that goes 1.5."""
    disc = np.clip(45.5 - np.hypot(X - 120 - 14 * t, Y - 130 - 4 * t), 0, 1)
    image: Plane = GROUND(X - 1.5 * t, Y) * (1 - disc) + OBJECT(X - 14 * t, Y - 4 * t) * disc
    return image


def dimming(t: float) -> Plane:
    return GROUND(X, Y) * (1 - 0.3 * t)


def moving_and_dimming(t: float) -> Plane:
    return GROUND(X - 5 * t, Y) * (1 - 0.2 * t)


def still(t: float) -> Plane:
    return GROUND(X, Y)


def flat(t: float) -> Plane:
    return np.full_like(X, 120.0)


def changing_scene(t: float) -> Plane:
    return GROUND(X, Y) * (1 - t) + OBJECT(Y, X) * t


def seen(scene: Scene, t: float, noise_dn: float, dtype: type = np.uint8) -> Image:
    noise = np.random.default_rng(round(1000 * t)).normal(0, 1, X.shape) * noise_dn
    grey = np.clip(scene(t) + noise, 0, 255)
    image: Image = np.rint(grey).astype(np.uint8) if dtype is np.uint8 else grey.astype(np.float32)
    return image


def frames_between(v0: Image, v1: Image, how: Upsampling, span_us: int = SPAN_US) -> list[Frame]:
    first, *inner, last = between([Frame(v0, 0), Frame(v1, span_us)], how)
    assert first.image is v0
    assert last.image is v1
    assert all(frame.image.dtype == np.float32 and frame.image.shape == v0.shape for frame in inner)
    return inner


def psnr(image: Plane, truth: Plane) -> float:
    return float(10 * np.log10(255**2 / np.mean((image - truth) ** 2)))


def margins(scene: Scene, noise_dn: float = 1.0, dtype: type = np.uint8) -> list[float]:
    """How much better than a linear blend, in dB, at each quarter."""
    v0, v1 = seen(scene, 0, noise_dn, dtype), seen(scene, 1, noise_dn, dtype)
    out = []
    for frame in frames_between(v0, v1, 4):
        t = frame.t_us / SPAN_US
        blend = (1 - t) * v0.astype(np.float64) + t * v1
        out.append(psnr(frame.image, scene(t)) - psnr(blend, scene(t)))
    return out


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
@pytest.mark.parametrize(
    ("scene", "margin_db"),
    [
        (moving(5.3, -2.1), 15),
        (moving(-3, 0), 11),
        (moving(20, 8), 12),
        (turning, 12),
        (moving_and_dimming, 14),
        (covering, 6),
    ],
)
def test_known_motion_is_followed(scene: Scene, margin_db: float, dtype: type) -> None:
    gained_db = margins(scene, dtype=dtype)
    print(f"dB over linear: {np.round(gained_db, 1)}")  # noqa: T201
    assert min(gained_db) > margin_db


def test_what_enters_the_image_comes_from_the_frame_that_shows_it() -> None:
    """20 pixels of the left border are in the second frame only, of the right border in the first only."""
    scene = moving(20, 0)
    for frame in frames_between(seen(scene, 0, 0), seen(scene, 1, 0), 4):
        truth = scene(frame.t_us / SPAN_US)
        for border in (np.s_[16:-16, 1:20], np.s_[16:-16, -20:-1]):
            assert psnr(frame.image[border], truth[border]) > 30


def test_what_is_uncovered_comes_from_the_second_frame() -> None:
    """Half way, the crescent that the disc has left so far is shown by the second frame only."""
    middle = frames_between(seen(covering, 0, 0), seen(covering, 1, 0), 2)[0]
    gone = (np.hypot(X - 120, Y - 130) < 44) & (np.hypot(X - 127, Y - 132) > 47)
    blend = (covering(0) + covering(1)) / 2
    assert psnr(middle.image[gone], covering(0.5)[gone]) > psnr(blend[gone], covering(0.5)[gone]) + 1.5


@pytest.mark.parametrize(
    ("scene", "noise_dn"), [(dimming, 0), (dimming, 2), (still, 0), (still, 2), (flat, 0), (flat, 2)]
)
def test_light_and_noise_are_no_motion(scene: Scene, noise_dn: float) -> None:
    v0, v1 = seen(scene, 0, noise_dn), seen(scene, 1, noise_dn)
    assert frames_between(v0, v1, "auto") == []
    middle = frames_between(v0, v1, 2)[0].image
    half_way = np.sqrt((v0 + 20.0) * (v1 + 20.0)) - 20  # of ln(V + 20), which is what pixels see
    assert np.abs(middle - half_way).mean() < 0.3


def test_what_does_not_match_makes_no_events_and_takes_them_back() -> None:
    """Of two unrelated images, on average of ln(V + 20), nothing rises that then falls again."""
    v0, v1 = (np.rint(texture(seed, 6)(X, Y)).clip(0, 255) for seed in (3, 4))
    images = [frame.image for frame in frames_between(v0.astype(np.uint8), v1.astype(np.uint8), 8)]
    path = np.array([np.log(image + 20.0).mean() for image in (v0, *images, v1)])
    straight = np.linspace(path[0], path[-1], len(path))
    assert np.abs(path - straight).max() < 0.01


@pytest.mark.parametrize(("scene", "longest"), [(changing_scene, 1.5), (flat, 1.3)])
def test_where_flow_finds_nothing_pixels_go_straight(scene: Scene, longest: float) -> None:
    """Of two unrelated images, and of noise, flow makes some motion: detours would be false events."""
    v0, v1 = seen(scene, 0, 2), seen(scene, 1, 2)
    path = np.array([v0, *(frame.image for frame in frames_between(v0, v1, 8)), v1], np.float64)
    detour = np.abs(np.diff(path, axis=0)).sum() / np.abs(path[-1] - path[0]).sum()
    print(f"paths {detour:.2f} times as long as straight ones")  # noqa: T201
    assert detour < longest


def test_nothing_comes_between_when_the_light_goes_off() -> None:
    v0, v1 = seen(moving(5, 0), 0, 0), seen(moving(5, 0), 1, 0) // 3
    assert frames_between(v0, v1.astype(np.uint8), "auto") == []


@pytest.mark.parametrize(("speed", "steps"), [(0.4, 1), (1.6, 2), (5.5, 6), (9.5, 10), (30.0, 12)])
def test_auto_keeps_steps_below_a_pixel(speed: float, steps: int) -> None:
    scene = moving(0.8 * speed, 0.6 * speed)
    found = len(frames_between(seen(scene, 0, 1), seen(scene, 1, 1), "auto")) + 1
    assert steps <= found <= min(12, steps + 1)


def test_a_small_object_decides_the_number_of_steps() -> None:
    def scene(t: float) -> Plane:
        disc = np.clip(24.5 - np.hypot(X - 120 - 6 * t, Y - 130), 0, 1)
        image: Plane = GROUND(X, Y) * (1 - disc) + OBJECT(X - 6 * t, Y) * disc
        return image

    assert len(frames_between(seen(scene, 0, 1), seen(scene, 1, 1), "auto")) >= 3


@pytest.mark.parametrize("scene", [moving(5.3, -2.1), moving(20, 8), covering, changing_scene])
def test_no_pixel_jumps_at_a_frame_or_between(scene: Scene) -> None:
    """The path of each pixel is as smooth near frames as between: no one of 500 steps is more than half a
    usual threshold, also where an edge passes by."""
    v0, v1 = seen(scene, 0, 0), seen(scene, 1, 0)
    images = [v0.astype(np.float32), *(f.image for f in frames_between(v0, v1, 500)), v1.astype(np.float32)]
    assert len(images) == 501
    worst = [np.abs(late - early).max() for early, late in pairwise(images)]
    print(f"largest step {max(worst):.1f}, at the ends {worst[0]:.1f} {worst[-1]:.1f} DN")  # noqa: T201
    assert max(worst) < 13
    assert max(worst[0], worst[-1]) < 7


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (8, 300), (12, 300), (31, 400), (400, 31), (16, 16)])
def test_images_too_small_for_flow_get_nothing_between(shape: tuple[int, int]) -> None:
    v0 = np.random.default_rng(1).integers(0, 256, shape).astype(np.uint8)
    assert frames_between(v0, np.roll(v0, 1, axis=1), "auto") == []
    assert frames_between(v0, np.roll(v0, 1, axis=1), 4) == []


@pytest.mark.parametrize("shape", [(32, 32), (33, 47), (32, 400), (401, 33), (64, 64), (90, 91), (180, 241)])
def test_small_and_odd_sizes(shape: tuple[int, int]) -> None:
    rows, columns = shape

    def scene(t: float) -> Plane:
        return GROUND(X - 2 * t, Y)[:rows, :columns] if rows <= HEIGHT else np.resize(still(t), shape)

    v0, v1 = (np.clip(np.rint(np.resize(scene(t), shape)), 0, 255).astype(np.uint8) for t in (0, 1))
    inner = frames_between(v0, v1, 3)
    assert len(inner) == 2
    assert all(np.isfinite(f.image).all() and f.image.min() >= 0 and f.image.max() <= 255.01 for f in inner)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_none_reach_the_simulator_alone(value: float) -> None:
    """It is the simulator that says what is wrong with a frame."""
    v0, v1 = seen(moving(5, 0), 0, 0, np.float32), seen(moving(5, 0), 1, 0, np.float32)
    v1[100, 100] = value
    with np.errstate(invalid="ignore", divide="ignore"):
        assert frames_between(v0, v1, "auto") == []


def test_the_number_of_opencv_threads_changes_nothing() -> None:
    v0, v1, threads = seen(covering, 0, 1), seen(covering, 1, 1), cv2.getNumThreads()
    results = []
    try:
        for number in (1, 2, 5):
            cv2.setNumThreads(number)
            results.append(np.array([frame.image for frame in frames_between(v0, v1, 4)]))
    finally:
        cv2.setNumThreads(threads)
    assert np.array_equal(results[0], results[1])
    assert np.array_equal(results[0], results[2])


def test_a_camera_in_a_hand_needs_several_steps_a_frame() -> None:
    """346 x 260 at 30 fps; the hand shakes by up to 6 pixels per frame and turns."""
    frames = []
    for i in range(16):
        dx, dy, angle = 25 * np.sin(0.25 * i), 8 * np.sin(0.4 * i), 0.02 * np.sin(0.3 * i)
        x, y = X - WIDTH / 2 - dx, Y - HEIGHT / 2 - dy
        image = GROUND(np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x)
        frames.append(Frame(np.clip(image, 0, 255).astype(np.uint8), i * SPAN_US))
    steps = (len(list(between(frames, "auto"))) - 1) / (len(frames) - 1)
    assert 3 < steps <= 12
