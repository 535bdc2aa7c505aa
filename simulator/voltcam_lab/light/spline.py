"""Light between frames, where all frames are known: each pixel's ln L on one cubic spline.

A monotone cubic, which a live source needs, cuts off every peak between two frames. A wave of six frames
loses 13 % of its height there, in the middle of a straight line too, and 0.4 % on a spline.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator, make_interp_spline

from .grey import USUAL_DARK_DN

Light = NDArray[np.float32]
STEPS = (1, 2, 4)
SAG = 0.002  # of ln L, a hundredth of a threshold: chords are no further from the curve, but where STEPS end
SHORTEST_US = 1250  # of a chord that is out of step
OUT_OF_STEP = 1.1338
"""Chords for one that sags enough: of no simple ratio to the frames, whichever number these have."""
NEARLY_ALL = 0.99  # of the pixels, whose chords decide
FEWEST = 4  # frames that a cubic spline needs


def along_spline(taken: NDArray[Any], taken_us: NDArray[np.int64]) -> tuple[Light, NDArray[np.int64]]:
    """Images (N, H, W) at t_us (N,): frames (M, H, W) at taken_us (M,), and others between them, so many that
    straight lines from one to the next are near the spline everywhere."""
    if len(taken) < FEWEST:
        return taken.astype(np.float32), taken_us
    log = np.log(taken.astype(np.float32) + np.float32(USUAL_DARK_DN))
    seconds = (taken_us - taken_us[0]) * 1e-6
    curve: Any = make_interp_spline(seconds, log, k=3)
    images, times = [], []
    for k in range(len(taken) - 1):
        images.append(taken[k].astype(np.float32))
        times.append(int(taken_us[k]))
        middle = curve(0.5 * (seconds[k] + seconds[k + 1]))
        sag = float(np.abs(middle - 0.5 * (log[k] + log[k + 1])).max())
        enough = next((steps for steps in STEPS if steps**2 * SAG >= sag), STEPS[-1])
        steps = min(enough, int(taken_us[k + 1] - taken_us[k]))
        for step in range(1, steps):
            t_us = int(taken_us[k] + (taken_us[k + 1] - taken_us[k]) * step // steps)
            light = np.exp(curve((t_us - taken_us[0]) * 1e-6)) - USUAL_DARK_DN
            images.append(np.maximum(light, 0).astype(np.float32))
            times.append(t_us)
    images.append(taken[-1].astype(np.float32))
    times.append(int(taken_us[-1]))
    return np.stack(images), np.array(times, np.int64)


def out_of_step(
    taken: NDArray[Any], taken_us: NDArray[np.int64], monotone: bool
) -> tuple[Light, NDArray[np.int64]]:
    """Images (N, H, W) at t_us (N,), at instants that do not keep step with the frames, but for the first and
    the last of these; so many that chords are near the curve for nearly all pixels.

    Where light bends, a chord is late at its begin and early at its end. Chords that begin with the frames
    would make events go with the frames' phase. monotone: on the monotone cubic of F. N. Fritsch and J.
    Butland (SIAM J. Sci. Stat. Comput. 5, 1984) instead of the spline.
    """
    if len(taken) < FEWEST:
        return taken.astype(np.float32), taken_us
    log = np.log(taken.astype(np.float32) + np.float32(USUAL_DARK_DN))
    seconds = (taken_us - taken_us[0]) * 1e-6
    curve: Any = PchipInterpolator(seconds, log) if monotone else make_interp_spline(seconds, log, k=3)
    sag = np.array([
        np.quantile(np.abs(curve(middle) - 0.5 * (former + after)), NEARLY_ALL)
        for middle, former, after in zip(0.5 * (seconds[1:] + seconds[:-1]), log[:-1], log[1:], strict=True)
    ])  # fmt: skip
    most = np.maximum(np.diff(taken_us) / SHORTEST_US, 1)
    chords = np.concatenate([[0], np.cumsum(np.clip(np.sqrt(sag / SAG), 1, most))])
    number = int(np.ceil(OUT_OF_STEP * chords[-1]))
    places = np.interp(np.linspace(0, chords[-1], number + 1), chords, taken_us)
    t_us = np.unique(np.round(places).astype(np.int64))
    light = [np.exp(curve((one - taken_us[0]) * 1e-6)) - USUAL_DARK_DN for one in t_us]
    return np.maximum(light, 0).astype(np.float32), t_us
