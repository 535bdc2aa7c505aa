"""What the light was before the camera rounded it to whole grey levels."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, uniform_filter
from scipy.signal import savgol_coeffs, savgol_filter

from voltcam_simulator.kernel import kernel

NEAR = 7  # pixels: a window of them moves together
SPANS = (5, 7)  # frames over which light may go as a cubic does
LIKE_ROUNDING = (
    1.8  # mean square of what a cubic leaves, of what rounding would, from where it is not used...
)
AS_BEFORE = 2.8  # ...at all; between these in part
ROUNDING_DN2 = 1 / 12  # variance of what rounding takes away
BUMP = 0.4  # grey levels: how far beyond the boundary light gets that comes and goes by the same one


def unrounded(frames: NDArray[Any]) -> NDArray[np.float32]:
    """Frames (M, H, W) of whole grey levels, as smooth as light that rounds to them may be.

    Where a pixel goes from one level to the next, light passes the boundary of the two, in the middle between
    two frames. From one boundary to the next it goes as its surroundings do: none where nothing moves. In the
    dark this is what pixels see: at 5 DN a step of one level is a quarter of a threshold at once.

    Light that passes several levels from frame to frame follows cubics, where these leave no more than
    rounding does: its zigzag would make simulated events early, as noise does.
    """
    levels = frames.reshape(len(frames), -1).astype(np.float32)
    change = np.abs(np.diff(frames.astype(np.float32), axis=0))
    window: Any = (3, NEAR, NEAR)
    moved = uniform_filter(change, size=window, mode="nearest").reshape(len(change), -1)
    moved += uniform_filter(change.mean(axis=(1, 2)), size=3, mode="nearest")[:, None]
    light = levels.copy()
    _smooth(levels, moved, light)
    return np.clip(_along_cubics(light.reshape(frames.shape)), frames - 0.5, frames + 0.5).astype(np.float32)


def _along_cubics(light: NDArray[np.float32]) -> NDArray[np.float32]:
    """Each pixel on the longest cubic of SPANS that leaves no more than rounding (Savitzky and Golay 1964);
    a pixel's neighbours in space and time help to tell."""
    found = light
    for span in (span for span in SPANS if span <= len(light)):
        cubic: NDArray[np.float32] = np.asarray(savgol_filter(light, span, 3, axis=0, mode="interp"))
        left = ROUNDING_DN2 * (1 - savgol_coeffs(span, 3)[span // 2])
        share = gaussian_filter((light - cubic) ** 2, 1.0) / left
        kept = np.clip((share - LIKE_ROUNDING) / (AS_BEFORE - LIKE_ROUNDING), 0, 1)
        found = np.asarray(cubic + kept * (found - cubic), np.float32)
    return found


@kernel
def _smooth(levels: Any, moved: Any, light: Any) -> None:
    """levels (M, pixels); moved (M - 1, pixels): how much goes on between two frames; light: the levels, to
    be made smooth."""
    frames, pixels = levels.shape
    for pixel in range(pixels):
        first = 0
        while first < frames:
            last = first
            while last + 1 < frames and levels[last + 1, pixel] == levels[first, pixel]:
                last += 1
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
