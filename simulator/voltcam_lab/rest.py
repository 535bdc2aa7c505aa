"""Pixels whose light never moves: how long until their first event. Without any, that is what tells of leak.

A leak mu takes the voltage from 0 to the threshold again and again. Seen from a moment of no meaning, as is the
start of a recording, it is anywhere on the way: the wait is uniform in 0..theta/mu (renewal theory: the forward
recurrence time). That end is blurred by BLUR, which stands for pixels that differ and for noise.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from .health.light import light_of
from .masks import Mask, Windows
from .scene import Scene

WAIT = np.dtype([
    ("pixel", "<i4"),
    ("level", "<f4"),  # mean light [DN]
    ("wait_us", "<f8"),
    ("seen", "?"),  # an ON event ended it; else it was not seen to end
    ("count", "<f4"),  # pixels like this one
])  # fmt: skip
Waits = NDArray[np.void]
NO_WAITS: Waits = np.zeros(0, WAIT)
BLUR = 0.1
GROUPS = 2000  # of pixels alike that showed nothing: few of them say little each, as scoring wants it
LEAST = 0.01  # of a probability: what else may have made or swallowed an event


def at_rest(scene: Scene) -> NDArray[np.bool_]:
    """(H, W): pixels whose frames, and neighbours, agree from first to last."""
    still: NDArray[np.bool_] = light_of(scene.taken, scene.taken_us).at_rest.all(axis=0)
    return still


def waits(
    events: NDArray[np.void], scene: Scene, still: NDArray[np.bool_], masked: Mask | Windows
) -> Waits:
    """Of the pixels `still` (H, W), from the first frame on; dtype WAIT. An event in a masked time, or an OFF
    event, ends a wait unseen."""
    mask = masked if isinstance(masked, Mask) else Mask(masked)
    begin_us, end_us = int(scene.taken_us[0]), int(scene.taken_us[-1])
    pixel = events["y"].astype(np.int64) * scene.width + events["x"]
    inside = np.flatnonzero((events["t"] >= begin_us) & (events["t"] < end_us) & still.ravel()[pixel])
    found, first = np.unique(pixel[inside], return_index=True)
    first = inside[first]  # events are sorted by time
    t_us = events["t"][first].astype(np.float64)
    start_us = np.maximum(mask.start(t_us, found // scene.width), begin_us)
    level = scene.taken.mean(axis=0).ravel()
    ended = np.zeros(len(found), WAIT)
    ended["pixel"], ended["level"], ended["count"] = found, level[found], 1
    ended["wait_us"], ended["seen"] = start_us - begin_us, events["p"][first] & (start_us == t_us)
    silent = np.setdiff1d(np.flatnonzero(still), found)
    silent = silent[np.argsort(level[silent], kind="stable")]
    groups = [group for group in np.array_split(silent, GROUPS) if group.size]
    quiet = np.zeros(len(groups), WAIT)
    quiet["pixel"] = [group[0] for group in groups]
    quiet["level"] = [level[group].mean() for group in groups]
    quiet["count"] = [group.size for group in groups]
    quiet["wait_us"] = (end_us - begin_us) * (1 - mask.share(begin_us, end_us))
    return np.concatenate([ended, quiet])


def log_likelihood(found: Waits, leak_per_us: NDArray[np.float64], theta: float) -> NDArray[np.float64]:
    """(n,): of each wait, where pixels drift to the threshold theta at leak_per_us (n,)."""
    rate = leak_per_us / theta
    z = (1 - found["wait_us"] * rate) / BLUR
    passing = rate * ((1 - LEAST) * ndtr(z) + LEAST)
    waiting = BLUR * (z * ndtr(z) + np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi))
    waiting = (1 - LEAST) * np.minimum(waiting, 1.0) + LEAST
    return found["count"] * np.log(np.where(found["seen"], passing, waiting))
