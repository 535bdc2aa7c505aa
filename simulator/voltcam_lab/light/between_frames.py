"""Light that frames tell of, less what cameras and interpolation add: noise at rest, blur between frames.

A simulator takes both for changes of the light: noise from frame to frame, and, once a frame, the change from
sharp to blurred and back, since frames moved by parts of a pixel and laid over one another blur.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, gaussian_filter1d, laplace, uniform_filter1d

from .grey import USUAL_DARK_DN, WHITE_DN
from .scale import white_dn
from .scene import CURVES, How, Scene, scene_of

NOISIEST_DN = 3.0  # of a difference between frames: more is motion
STILL_FRAMES = 5
LONGER_AND_LONGER = (5, 15, 45, 135)  # frames
NEAR_PIXELS = 1.5  # noise is a pixel's own, motion is its neighbours', too
WIDEST = 0.8  # pixels: the blur of linear interpolation half-way between four pixels is 0.7
HALVINGS = 5
ALIKE = 1.02  # ratio of powers that needs no blur
WELL_SAMPLED = 0.9  # share of the light that is trusted from which nothing better than a curve is looked for
HOPELESS = 0.4  # of the brightness: light that is less sure tells nothing more

Image = NDArray[np.float32]
Images = NDArray[np.float32]


def mean_doubt(scene: Scene) -> float:
    """How unsure the light is, of the brightness; all the same from HOPELESS on."""
    return float(np.minimum(scene.unsure, HOPELESS).mean())


def untrusted_share(scene: Scene) -> float:
    """Of pixels and time, by the scene's own `tolerance`."""
    return float(np.mean(~scene.trusted(scene.tolerance)))


def scene_between(
    frames: NDArray[Any],
    frame_t_us: NDArray[np.int64],
    columns: NDArray[np.int64] | None = None,
    doubt: Callable[[Scene], float] = mean_doubt,
    white: float | None = None,
) -> Scene:
    """The light of frames (M, H, W) and between them, by a spline, by a monotone cubic, which suits sudden
    changes, or by motion: that with less doubt.

    columns: only these of the picture. white: `white_dn` of the frames as they were taken; None: these are.
    """
    white = white_dn(frames) if white is None else white

    def filled(own: NDArray[Any], how: How) -> Scene:
        return replace(scene_of(own, frame_t_us, how), white_dn=white)

    own = frames if columns is None else frames[:, :, columns]
    curved = min((filled(own, how) for how in CURVES), key=doubt)
    if curved.trusted().mean() > WELL_SAMPLED:
        return curved
    moved = filled(frames, "auto")  # motion is seen in whole frames
    return min(curved, moved if columns is None else moved.in_columns(columns), key=doubt)


def calmed(scene: Scene) -> Scene:
    """The scene of frames that are `calm` over STILL_FRAMES."""
    frames = scene.taken.astype(np.float32)
    noise2 = float(np.mean(np.minimum(np.diff(frames, axis=0) ** 2, NOISIEST_DN**2))) / 2
    calmer = scene_of(calm(frames, noise2, (STILL_FRAMES,)), scene.taken_us, scene.how)
    return replace(calmer, white_dn=scene.white_dn)


def calm(frames: NDArray[Any], noise2: float, spans: Sequence[int] = LONGER_AND_LONGER) -> Images:
    """Frames (M, H, W) that are the mean over the longest of `spans` (frames) over which they differ by no
    more than noise of variance noise2 [DN^2] does, and as they were where they differ by twice that."""
    found: Images = frames.astype(np.float32)
    frames = found
    for span in spans:
        mean = uniform_filter1d(frames, span, axis=0, mode="nearest")
        differing = gaussian_filter((frames - mean) ** 2, (1.0, NEAR_PIXELS, NEAR_PIXELS))
        moving = np.clip(differing / max(noise2, 1e-6) - 1, 0, 1)
        found = np.asarray(mean + moving * (found - mean), np.float32)
    return found


def frame_noise2(frames: NDArray[Any]) -> float:
    """Variance [DN^2] of what is in one frame (of M, H, W) and not in those about it.

    It makes a step up be followed by a step down: the mean product of such differences is minus the variance,
    where motion, that goes on, adds to it. Differences above NOISIEST_DN are motion.
    """
    steps = np.diff(frames.astype(np.float32), axis=0)
    small = (np.abs(steps) <= 2 * NOISIEST_DN).astype(np.float32)
    both = small[1:] * small[:-1]
    return max(0.0, -float((steps[1:] * steps[:-1] * both).sum() / max(both.sum(), 1.0)))


def evened(scene: Scene) -> Scene:
    """All images blurred as the blurriest one between the same two frames is; `taken` stays as it is."""
    power = np.array([_power(image) for image in scene.images])
    edges = np.searchsorted(scene.t_us, scene.taken_us)
    least = np.array([power[i : j + 1].min() for i, j in pairwise(edges.tolist())])
    middle = 0.5 * (scene.taken_us[1:] + scene.taken_us[:-1])
    wanted = np.interp(scene.t_us, middle, gaussian_filter1d(least, 1.0))
    even = [
        _blurred_to(image, most) if own > ALIKE * most else image
        for image, own, most in zip(scene.images, power, wanted.tolist(), strict=True)
    ]
    return replace(scene, images=np.stack(even))


def sharpened(scene: Scene, amount: float) -> Scene:
    """Each image plus `amount` times what a Gaussian of one pixel takes away from it."""
    blurred = gaussian_filter(scene.images, (0, 1, 1))
    highest = max(WHITE_DN, float(scene.images.max(initial=0)))
    return replace(
        scene, images=np.clip(scene.images + np.float32(amount) * (scene.images - blurred), 0, highest)
    )


def _power(image: NDArray[Any]) -> float:
    """Of the finest structure, in ln L: what pixels see of it."""
    return float(np.mean(laplace(np.log(image + np.float32(USUAL_DARK_DN))) ** 2))


def _blurred_to(image: Image, power: float) -> Image:
    low, high = 0.0, WIDEST
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _power(gaussian_filter(image, middle)) > power:
            low = middle
        else:
            high = middle
    return np.asarray(gaussian_filter(image, 0.5 * (low + high)), np.float32)
