"""Light between frames, where all frames are known: each pixel's ln L on one cubic spline.

A monotone cubic, which a live source needs, cuts off every peak between two frames. A wave of six frames
loses 13 % of its height there, in the middle of a straight line too, and 0.4 % on a spline.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from .grey import USUAL_DARK_DN

Light = NDArray[np.float32]
STEPS = (1, 2, 4)
SAG = 0.002  # of ln L, a hundredth of a threshold: chords are no further from the curve, but where STEPS end
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
