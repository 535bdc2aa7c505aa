"""Scenes whose photographs are smooth or even, so that light itself tells where a point is."""

from typing import Any

import cv2
import numpy as np
import pytest

from voltcam_video.photos import PhotoScene, displaced

WIDTH, HEIGHT = 96, 72
T_US = 300_000


def textured(seed: int, size: tuple[int, int] = (150, 200)) -> np.ndarray:
    """A photograph of light with waves of 25 to 60 pixels."""
    rng = np.random.default_rng(seed)
    y, x = np.indices(size)
    waves = sum(
        np.sin(2 * np.pi * (x * np.cos(a) + y * np.sin(a)) / period + phase)
        for a, period, phase in zip(
            rng.uniform(0, 6, 6), rng.uniform(25, 60, 6), rng.uniform(0, 6, 6), strict=True
        )
    )
    return (128 + 20 * waves).astype(np.float32)


def even(light: float) -> np.ndarray:
    return np.full((40, 50), light, np.float32)


def scene(seed: int = 0, layers: int = 4, **more: Any) -> PhotoScene:
    photographs = [textured(i) for i in range(5)]
    return PhotoScene(photographs, WIDTH, HEIGHT, layers=layers, seed=seed, **more)


def test_the_same_seed_gives_the_same_scene_at_any_time_in_any_order() -> None:
    first, again, other = scene(1), scene(1), scene(2)
    again.frame(0)
    np.testing.assert_array_equal(first.frame(T_US), again.frame(T_US))
    np.testing.assert_array_equal(first.flow(T_US), again.flow(T_US))
    assert np.abs(first.frame(T_US) - other.frame(T_US)).max() > 10


def test_a_frame_is_light_in_floats() -> None:
    frame = scene().frame(T_US)
    assert frame.dtype == np.float32
    assert frame.shape == (HEIGHT, WIDTH)
    grey = PhotoScene([np.full((9, 9), 188, np.uint8)], WIDTH, HEIGHT, layers=3).frame(T_US)
    np.testing.assert_allclose(grey, 255 * ((188 / 255 + 0.055) / 1.055) ** 2.4, rtol=1e-5)


def test_flow_is_the_derivative_of_where_a_point_goes() -> None:
    step_us = 50.0
    y, x = np.indices((HEIGHT, WIDTH), dtype=np.float64)
    for seed in range(10):
        made = scene(seed)
        order, flow = made.order(T_US), made.flow(T_US)
        here = np.linalg.inv(made.homographies(T_US))
        ways = []
        for t_us in (T_US - step_us, T_US + step_us):
            there = made.homographies(t_us)
            at = np.empty((HEIGHT, WIDTH, 2))
            for layer in range(made.layers):
                each = order == layer
                at[each] = np.stack(displaced(x[each], y[each], there[layer] @ here[layer]), axis=-1)
            ways.append(at)
        np.testing.assert_allclose(flow, (ways[1] - ways[0]) / (2e-6 * step_us), rtol=1e-4, atol=1e-2)


@pytest.mark.parametrize("seed", range(6))
def test_light_moves_with_the_flow(seed: int) -> None:
    """What a pixel of the background shows is found again where its homography takes it."""
    made, later_us = scene(seed, layers=1), T_US + 30_000
    matrix = made.homographies(later_us)[0] @ np.linalg.inv(made.homographies(T_US)[0])
    y, x = np.indices((HEIGHT, WIDTH), dtype=np.float64)
    u, v = displaced(x, y, matrix)
    assert np.hypot(u - x, v - y).max() > 1
    inside = (u > 0) & (u < WIDTH - 1) & (v > 0) & (v < HEIGHT - 1)
    assert inside.mean() > 0.5
    left, top = np.floor(u[inside]).astype(int), np.floor(v[inside]).astype(int)
    across, down = u[inside] - left, v[inside] - top
    later = made.frame(later_us)
    upper = later[top, left] * (1 - across) + later[top, left + 1] * across
    lower = later[top + 1, left] * (1 - across) + later[top + 1, left + 1] * across
    error = upper * (1 - down) + lower * down - made.frame(T_US)[inside]
    assert np.sqrt(np.mean(error**2)) < 0.02 * made.frame(T_US).std()


def test_light_changes_as_the_flow_and_the_slope_of_light_say() -> None:
    """The optical flow equation, dI/dt = -v . grad I, where one plane is seen."""
    made, step_us = scene(3, layers=1), 200.0
    change = (made.frame(T_US + step_us) - made.frame(T_US - step_us)) / (2e-6 * step_us)
    down, across = np.gradient(made.frame(T_US).astype(np.float64))
    flow = made.flow(T_US)
    told = -(flow[..., 0] * across + flow[..., 1] * down)
    inner = np.s_[2:-2, 2:-2]
    assert np.corrcoef(change[inner].ravel(), told[inner].ravel())[0, 1] > 0.995


def test_order_says_which_of_two_covers_more() -> None:
    """A black and a white plane: light is the share of white."""
    both = 0
    for seed in range(12):
        made = PhotoScene([even(0.0), even(200.0)], WIDTH, HEIGHT, layers=2, seed=seed)
        times_us = np.linspace(0, 4e6, 9).tolist()
        frames = np.stack([made.frame(t_us) for t_us in times_us]) / 200
        order = np.stack([made.order(t_us) for t_us in times_us])
        white_behind = np.median(frames) > 0.5  # a cut-out is smaller than half of the frame
        share = 1 - frames if white_behind else frames
        clear = np.abs(share - 0.5) > 1e-4
        np.testing.assert_array_equal(order[clear], (share > 0.5)[clear])
        both += set(np.unique(order).tolist()) == {0, 1}
    assert both > 6


def test_nearer_planes_hide_farther_ones() -> None:
    """Even photographs: away from edges a plane shows its own light, and none behind hides its middle."""
    lights = np.array([10.0, 20.0, 40.0, 80.0, 160.0])
    hidden = 0
    for seed in range(8):
        made = PhotoScene([even(light) for light in lights], 200, 150, layers=5, seed=seed)
        of_layer: dict[int, int] = {}
        for t_us in np.linspace(0, 8e6, 12).tolist():
            frame, order = made.frame(t_us), made.order(t_us)
            for n in np.unique(order).tolist():
                inner = cv2.erode((order == n).astype(np.uint8), np.ones((33, 33)), borderValue=0) > 0
                if inner.any():
                    which = int(np.abs(lights - np.median(frame[inner])).argmin())
                    np.testing.assert_allclose(frame[inner], lights[which], rtol=0.01)
                    assert of_layer.setdefault(n, which) == which
            for n, matrix in enumerate(made.homographies(t_us)):
                x, y = np.round(matrix[:2, 2] / matrix[2, 2]).astype(int).tolist()
                if 0 <= x < 200 and 0 <= y < 150:
                    assert order[y, x] >= n
                    hidden += order[y, x] > n > 0
        assert len(set(of_layer.values())) == len(of_layer)
    assert hidden > 3


def test_a_crop_is_a_part_of_the_frame() -> None:
    for seed in range(4):
        whole, part = scene(seed), scene(seed, crop=(50, 20, 33, 41))
        here = np.s_[20:61, 50:83]
        assert part.frame(T_US).shape == (41, 33)
        np.testing.assert_allclose(part.frame(T_US), whole.frame(T_US)[here], atol=1e-2)
        assert (part.order(T_US) == whole.order(T_US)[here]).mean() > 0.999
        same = part.order(T_US) == whole.order(T_US)[here]
        np.testing.assert_allclose(part.flow(T_US)[same], whole.flow(T_US)[here][same], rtol=1e-3, atol=1e-2)


def test_cutouts_pass_and_are_away_at_times() -> None:
    made = scene(5, layers=2)
    seen = [(made.order(t_us) == 1).mean() for t_us in np.linspace(0, 3e7, 300)]
    assert min(seen) == 0
    assert max(seen) > 0.03


def test_faster_scenes_are_the_same_in_less_time() -> None:
    np.testing.assert_allclose(
        scene(1).frame(T_US), scene(1, speed_px_s=200.0).frame(T_US / 2), rtol=1e-4, atol=1e-3
    )


def test_only_photographs_that_are_drawn_are_looked_at() -> None:
    class Counted(list[np.ndarray]):
        looked = 0

        def __getitem__(self, index: int) -> np.ndarray:  # type: ignore[override]
            self.looked += 1
            return super().__getitem__(index)

    photographs = Counted(textured(i) for i in range(9))
    PhotoScene(photographs, WIDTH, HEIGHT, layers=3)
    assert photographs.looked == 3


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"photographs": []}, "needs a photograph"),
        ({"width": 1}, "at least 2 x 2"),
        ({"crop": (1, 0, 8, 8)}, "not within a frame of 8 x 8"),
        ({"crop": (0, 0, 0, 8)}, "not within a frame of 8 x 8"),
        ({"layers": 0}, "1 to 255 layers"),
        ({"layers": 256}, "1 to 255 layers"),
        ({"speed_px_s": 0.0}, "a speed is above 0"),
        ({"speed_px_s": float("nan")}, "a speed is above 0"),
    ],
)
def test_what_cannot_be_is_refused(change: dict[str, object], says: str) -> None:
    asked: dict[str, object] = {"photographs": [even(1.0)], "width": 8, "height": 8, **change}
    with pytest.raises(ValueError, match=says):
        PhotoScene(**asked)  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [(1, 5000), (5000, 1), (3, 900)])
def test_a_long_thin_photograph_is_cut(size: tuple[int, int]) -> None:
    made = PhotoScene([np.full(size, 9.0, np.float32)], 40, 30, layers=2)
    np.testing.assert_allclose(made.frame(T_US), 9.0, rtol=1e-5)


def test_a_photograph_of_one_pixel_is_one() -> None:
    np.testing.assert_allclose(PhotoScene([np.full((1, 1), 7.0)], 8, 8).frame(T_US), 7.0, rtol=1e-5)
