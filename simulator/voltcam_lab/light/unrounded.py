"""What the light was before the camera rounded it to whole grey levels."""

from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.fft import dctn, idctn
from scipy.ndimage import uniform_filter

from voltcam_simulator.kernel import kernel

NEAR = 7  # pixels: a window of them moves together
BUMP = 0.4  # grey levels: how far beyond the boundary light gets that comes and goes by the same one
BLOCK = 8  # frames, and pixels each way: what moves has few cosines in it, rounding a little of all
STEPS = (4, 2, 2)  # frames and pixels from one block to the next
SHIFT = 0.25  # grey levels: light that moves by more from frame to frame is rounded at random
NOISE_DN = 3 * 12**-0.5  # three standard deviations of rounding's error: smaller cosines are taken for it

Light = NDArray[np.float32]


def unrounded(frames: NDArray[Any]) -> Light:
    """Frames (M, H, W) of whole grey levels, as smooth as light that rounds to them may be.

    Where a pixel stays on a level for longer than a block and goes to the next, light passes the boundary of
    the two in the middle between two frames. From one boundary to the next it goes as its surroundings do:
    none where nothing moves. In the dark this is what pixels see: at 5 DN a step of one level is a quarter of
    a threshold at once.

    Light that moves faster loses the cosines that are no larger than rounding makes them, in blocks of frames
    and pixels that overlap (Donoho and Johnstone 1994; blocks as of Yaroslavsky, Egiazarian and Astola 2001).
    Else its zigzag would make simulated events early, as noise does.
    """
    levels = frames.reshape(len(frames), -1).astype(np.float32)
    change = np.abs(np.diff(frames.astype(np.float32), axis=0))
    window: Any = (3, NEAR, NEAR)
    moved = uniform_filter(change, size=window, mode="nearest").reshape(len(change), -1)
    moved += uniform_filter(change.mean(axis=(1, 2)), size=3, mode="nearest")[:, None]
    light = levels.copy()
    _smooth(levels, moved, light)
    smooth = _without_small_cosines(light.reshape(frames.shape))
    return np.clip(smooth, frames - 0.5, frames + 0.5).astype(np.float32)


def rounding_errors(light: Light) -> NDArray[np.float16]:
    """(2, M, H, W) [DN]: what `light`, frames (M, H, W) that were `unrounded`, may be off by.

    It is what the same way makes of that light itself, rounded once more (a parametric bootstrap: Efron
    1979). Where light moves, rounding's error is a random one: what was found lies too near to whole levels
    to be rounded to others. Where it rests, the boundaries of levels are some `SHIFT` higher or lower: where
    they are, it would be found again exactly.
    """
    moves = np.zeros(light.shape, np.bool_)
    steps = np.abs(np.diff(light, axis=0)) > SHIFT
    moves[1:] |= steps
    moves[:-1] |= steps
    errors = []
    for seed, shift in enumerate((-SHIFT, SHIFT)):
        at_random = light + np.random.default_rng(seed).random(light.shape, np.float32) - np.float32(0.5)
        again = np.where(moves, at_random, np.floor(light + np.float32(shift + 0.5)) - np.float32(shift))
        errors.append(light - np.maximum(unrounded(again), 0))
    return np.stack(errors).astype(np.float16)


def _without_small_cosines(light: Light) -> Light:
    """The mean of all blocks that have a sample in them; those of fewer cosines count for more."""
    padded = np.pad(light, BLOCK, mode="symmetric")
    blocks = sliding_window_view(padded, (BLOCK,) * light.ndim)[:: STEPS[0], :: STEPS[1], :: STEPS[2]]
    total, weights = np.zeros_like(padded), np.zeros_like(padded)
    for number, row in enumerate(blocks):
        cosines: Any = dctn(row, axes=(2, 3, 4), norm="ortho")
        mean = cosines[:, :, 0, 0, 0].copy()
        cosines[np.abs(cosines) < NOISE_DN] = 0
        cosines[:, :, 0, 0, 0] = mean
        weight = 1 / np.maximum(np.count_nonzero(cosines, axis=(2, 3, 4)), 1).astype(np.float32)
        found = idctn(cosines, axes=(2, 3, 4), norm="ortho")
        here = slice(number * STEPS[0], number * STEPS[0] + BLOCK)
        _add_blocks(found, weight, STEPS[1], STEPS[2], total[here], weights[here])
    inside = (slice(BLOCK, -BLOCK),) * light.ndim
    return np.asarray(total[inside] / weights[inside], np.float32)


@kernel
def _add_blocks(blocks: Any, weight: Any, down: Any, right: Any, total: Any, weights: Any) -> None:
    """blocks (rows, columns, frames, pixels, pixels) from each `down` and `right` on, to total and weights
    (frames, H, W)."""
    rows, columns, frames, height, width = blocks.shape
    for row in range(rows):
        for column in range(columns):
            own, y0, x0 = weight[row, column], row * down, column * right
            for k in range(frames):
                for y in range(height):
                    for x in range(width):
                        total[k, y0 + y, x0 + x] += own * blocks[row, column, k, y, x]
                        weights[k, y0 + y, x0 + x] += own


@kernel
def _smooth(levels: Any, moved: Any, light: Any) -> None:
    """levels (M, pixels); moved (M - 1, pixels): how much goes on between two frames; light: the levels, to
    be made smooth where they stay for longer than a block."""
    frames, pixels = levels.shape
    for pixel in range(pixels):
        first = 0
        while first < frames:
            last = first
            while last + 1 < frames and levels[last + 1, pixel] == levels[first, pixel]:
                last += 1
            if last - first >= BLOCK:
                _run(levels, moved, light, pixel, first, last)
            first = last + 1


@kernel
def _run(levels: Any, moved: Any, light: Any, pixel: Any, first: Any, last: Any) -> None:
    """One level, from frame `first` to `last`."""
    level, frames = levels[first, pixel], levels.shape[0]
    entered = levels[first - 1, pixel] - level if first > 0 else 0.0
    left = levels[last + 1, pixel] - level if last + 1 < frames else 0.0
    begin = 0.5 * entered if abs(entered) == 1 else 0.0  # faster light tells nothing of where it was
    end = 0.5 * left if abs(left) == 1 else 0.0
    before = 0.5 * moved[first - 1, pixel] if begin != 0 else 0.0
    way = before + (0.5 * moved[last, pixel] if end != 0 else 0.0)
    for k in range(first, last):
        way += moved[k, pixel]
    if way == 0:
        return
    bulge = -8 * BUMP * begin if begin == end else 0.0
    gone = before
    for k in range(first, last + 1):
        s = gone / way
        light[k, pixel] = level + begin + s * (end - begin) + s * (1 - s) * bulge
        if k < last:
            gone += moved[k, pixel]
