"""Where light stands still: its range over a window of time stays below a limit.

Each reader asks on another time scale, and each limit is set by what else moves a grey level there:

| reader | window | limit | what sets the limit |
|---|---|---|---|
| health | 500 ms to each side of each frame | 6 sd of frame noise and 1 DN | the noise of single frames |
| distances | 200 ms about each pair of frames | .12 of ln(L + 20) | noise of single frames reaches .1 |
| statistics | three buckets of 20 ms back, one ahead | .06 of ln(L + k2) | a third of a threshold |
| paper's method | 50 ms before and after an interval | .03 of ln(L + 20) | slopes within a bin |
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, maximum_filter, maximum_filter1d, minimum_filter, minimum_filter1d

from voltcam_simulator.kernel import kernel

from .grey import USUAL_DARK_DN
from .scene import Scene

STEADY_US, STEADY_ROWS = 500_000, 16  # rows that are worked on together, for the sake of memory
PAIR_WINDOW_US, PAIR_LIMIT, PAIR_NEIGHBOURS = 200_000, 0.12, 5
BUCKET_US, BUCKETS_BEFORE, BUCKETS_AFTER, BUCKET_LIMIT = 20_000, 3, 1, 0.06
INTERVAL_AROUND_US, INTERVAL_LIMIT = 50_000.0, 0.03
BLACK_DN, CLIPPED_SHARE = 2.0, 0.97
"""Below the one, and above this share of the brightest, light may move unseen."""


def steady_pairs(images: NDArray[np.uint8], t_us: NDArray[np.int64], noise_dn: float) -> NDArray[np.bool_]:
    """(N - 1, H, W): over STEADY_US around two frames (N, H, W) a pixel and its neighbours kept their level.

    noise_dn: standard deviation of a frame's grey level.
    """
    count, height, width = images.shape
    period_us = float(np.median(np.diff(t_us)))
    window = 2 * round(min(STEADY_US / period_us, count)) + 1
    found = np.empty((count - 1, height, width), np.bool_)
    for top in range(0, height, STEADY_ROWS):
        rows = slice(top, top + STEADY_ROWS)
        high, low = (f(images[:, rows], window, axis=0) for f in (maximum_filter1d, minimum_filter1d))
        steady = high - low <= 6 * noise_dn + 1
        found[:, rows] = steady[1:] & steady[:-1]
    for plane in found:
        minimum_filter(plane, 3, output=plane)
    return found


def still_pairs(images: NDArray[np.uint8], t_us: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(N - 1, H, W): between two of the frames (N, H, W) light changed neither at a pixel nor next to it."""
    log = np.stack([np.log(gaussian_filter(i.astype(np.float32), 1) + USUAL_DARK_DN) for i in images])
    first = np.searchsorted(t_us, t_us[:-1] - PAIR_WINDOW_US // 2)
    last = np.searchsorted(t_us, t_us[1:] + PAIR_WINDOW_US // 2, side="right")
    planes = []
    for begin, end in zip(first, last, strict=True):
        span = np.ptp(log[begin:end], axis=0)
        planes.append(maximum_filter(span, PAIR_NEIGHBOURS) < PAIR_LIMIT)
    return np.stack(planes)


def still_intervals(
    scene: Scene, intervals: NDArray[np.void], around_us: float = INTERVAL_AROUND_US
) -> NDArray[np.bool_]:
    """(n,): light stood still during intervals between events (n,), and around them.

    A short interval alone would always seem still. intervals: fields pixel, start_us, end_us, before, after.
    """
    planes = scene.images.reshape(len(scene.images), -1)
    levels = [intervals["before"], intervals["after"]]
    for t_us in (intervals["start_us"] - around_us, intervals["end_us"] + around_us):
        nearest = np.clip(np.searchsorted(scene.t_us, t_us), 0, len(planes) - 1)
        levels.append(planes[nearest, intervals["pixel"]])
    seen = np.array(levels)
    still = np.ptp(np.log(seen + USUAL_DARK_DN), axis=0) < INTERVAL_LIMIT
    clipped = (seen.min(axis=0) < BLACK_DN) | (seen.max(axis=0) > CLIPPED_SHARE * planes.max())
    return np.asarray(still & ~clipped)


def still_steps(log_light: NDArray[np.float32], t_us: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(K, N - 1): between two of N instants the ln(L + k2) of K pixels (K, N) stays within BUCKET_LIMIT."""
    steps: NDArray[np.bool_] = _still_steps(
        log_light, t_us, BUCKET_US, BUCKETS_BEFORE, BUCKETS_AFTER, BUCKET_LIMIT
    )
    return steps


@kernel
def _still_steps(log_light: Any, t_us: Any, bucket_us: Any, before: Any, after: Any, limit: Any) -> Any:
    """Light runs straight between instants: each step's ends stand for all buckets of time it touches."""
    pixels, steps = log_light.shape[0], log_light.shape[1] - 1
    buckets = (t_us[steps] - t_us[0]) // bucket_us + 1
    low, high = np.empty(buckets, np.float32), np.empty(buckets, np.float32)
    resting = np.empty((pixels, steps), np.bool_)
    for k in range(pixels):
        low[:], high[:] = np.inf, -np.inf
        for s in range(steps):
            u, v = log_light[k, s], log_light[k, s + 1]
            for b in range((t_us[s] - t_us[0]) // bucket_us, (t_us[s + 1] - t_us[0]) // bucket_us + 1):
                low[b], high[b] = min(low[b], u, v), max(high[b], u, v)
        for s in range(steps):
            first = max((t_us[s] - t_us[0]) // bucket_us - before, 0)
            last = min((t_us[s + 1] - t_us[0]) // bucket_us + after, buckets - 1)
            bottom, top = np.float32(np.inf), np.float32(-np.inf)
            for b in range(first, last + 1):
                bottom, top = min(bottom, low[b]), max(top, high[b])
            resting[k, s] = top - bottom < limit
    return resting
