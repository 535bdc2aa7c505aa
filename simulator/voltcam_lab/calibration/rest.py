"""Pixels whose light stands still: how long until their first event. Without any, that is what tells of leak.

A leak mu takes the voltage from 0 to the threshold again and again. Seen from a moment of no meaning, as is
the start of a recording, it is anywhere on the way: the wait is uniform in 0..theta/mu (renewal theory: the
forward recurrence time). That end is blurred by BLUR, which stands for pixels that differ. Noise alone ends
waits at the rate sigma^2 / (theta_on theta_off), the mean of a Wiener process between two barriers, half of
them OFF.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, ndtr

from ..health.light_change import light_change_of
from ..light.scale import is_black, is_white
from ..light.scene import Scene
from ..windows import Mask, Windows

WAIT = np.dtype([
    ("pixel", "<i4"),
    ("level", "<f4"),  # mean light [DN]
    ("wait_us", "<f8"),
    ("end", "i1"),  # +1 an ON event, -1 an OFF event, 0: it was not seen to end
    ("count", "<f4"),  # pixels like this one
])  # fmt: skip
Waits = NDArray[np.void]
NO_WAITS: Waits = np.zeros(0, WAIT)
LEAST_US = 200_000  # of a rest, of which frames said that it was longer before and after
BLUR = 0.1
GROUPS = 2000  # of pixels alike that showed nothing: few of them say little each, as scoring wants it
LEAST = 0.01  # share of the pixels that leak by chance, not in turn: whatever else a pixel may do


@dataclass(frozen=True, eq=False)
class Rest:
    """level_dn: (H, W) mean light. begin_us, end_us: (H, W) of each pixel's longest rest; the same where it
    has none."""

    level_dn: NDArray[np.float32]
    begin_us: NDArray[np.int64]
    end_us: NDArray[np.int64]


def rest_of(scene: Scene) -> Rest:
    """When frames agree, at a pixel and next to it, on a light that is neither black nor white."""
    light = light_change_of(scene.taken, scene.taken_us)
    told = ~(is_black(scene.taken) | is_white(scene.taken, scene.white_dn))
    shape = light.mean_dn.shape
    begin, best_begin, best_end = (np.zeros(shape, np.int64) for _ in range(3))
    run = np.zeros(shape, np.bool_)
    resting = light.at_rest & told[1:] & told[:-1]
    for still, start_us, end_us in zip(resting, light.t_us[:-1], light.t_us[1:], strict=True):
        begin = np.where(still & ~run, start_us, begin)
        longer = still & (end_us - begin > best_end - best_begin)
        best_begin, best_end = np.where(longer, begin, best_begin), np.where(longer, end_us, best_end)
        run = still
    return Rest(light.mean_dn, best_begin, best_end)


def waits(events: NDArray[np.void], rest: Rest, keep: NDArray[np.bool_], masked: Mask | Windows) -> Waits:
    """Of the pixels `keep` (H, W) that rest for LEAST_US, from when they do; dtype WAIT. An event in a masked
    time ends a wait unseen."""
    mask = masked if isinstance(masked, Mask) else Mask(masked)
    begin_us, end_us = rest.begin_us.ravel(), rest.end_us.ravel()
    resting = keep.ravel() & (end_us - begin_us >= LEAST_US)
    pixel = events["y"].astype(np.int64) * keep.shape[1] + events["x"]
    t_us = events["t"]
    inside = np.flatnonzero(resting[pixel] & (t_us >= begin_us[pixel]) & (t_us < end_us[pixel]))
    found, first = np.unique(pixel[inside], return_index=True)
    first = inside[first]  # events are sorted by time
    at_us = t_us[first].astype(np.float64)
    start_us = np.maximum(mask.start(at_us, found // keep.shape[1]), begin_us[found])
    level = rest.level_dn.ravel()
    ended = np.zeros(len(found), WAIT)
    ended["pixel"], ended["level"], ended["count"] = found, level[found], 1
    ended["wait_us"] = start_us - begin_us[found]
    ended["end"] = np.where(start_us == at_us, np.where(events["p"][first], 1, -1), 0)
    silent = np.setdiff1d(np.flatnonzero(resting), found)
    silent = silent[np.argsort(level[silent], kind="stable")]
    groups = [group for group in np.array_split(silent, GROUPS) if group.size]
    quiet = np.zeros(len(groups), WAIT)
    quiet["pixel"] = [group[0] for group in groups]
    quiet["level"] = [level[group].mean() for group in groups]
    quiet["count"] = [group.size for group in groups]
    seen = 1 - mask.share(int(rest.begin_us.min()), int(rest.end_us.max())) if groups else 1.0
    quiet["wait_us"] = [seen * (end_us[group] - begin_us[group]).mean() for group in groups]
    return np.concatenate([ended, quiet])


def log_likelihood(
    found: Waits, leak_per_us: NDArray[np.float64], noise_per_us: NDArray[np.float64], theta_on: float
) -> NDArray[np.float64]:
    """(n,): of each wait, with leak (n,) [1/us] and noise sigma^2 (n,) [1/us]; theta_on theta_off = 1."""
    rate = leak_per_us / theta_on
    share = found["wait_us"] * rate
    z = (1 - share) / BLUR
    own = BLUR * (z * ndtr(z) + np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi))
    other = np.log(LEAST) - share
    noisy = noise_per_us * found["wait_us"]
    waiting = np.logaddexp(np.log((1 - LEAST) * np.clip(own, 1e-300, 1.0)), other) - noisy
    passing = np.logaddexp(np.log1p(-LEAST) + log_ndtr(z), other) - noisy + np.log(rate)
    by_noise = np.log(0.5 * noise_per_us) + waiting
    ended = np.where(found["end"] > 0, np.logaddexp(passing, by_noise), by_noise)
    return np.asarray(found["count"] * np.where(found["end"] != 0, ended, waiting))
