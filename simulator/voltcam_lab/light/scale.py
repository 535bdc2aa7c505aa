"""Where the scale of a camera's frames ends: there, light moves and grey levels do not tell."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .grey import WHITE_DN

ROUNDING_DN = 0.5  # by which a grey level that is no whole number may be off
_FROZEN = 0.4  # of the levels are the same in the next frame: with noise of 0.7 DN or more, fewer are
_TIMES = 2.0  # as often as usual. Noise grows with light, so the brightest levels change the soonest
_FEWEST = 1e-3  # of the samples: what is at one level, to tell of it


def white_dn(frames: NDArray[Any]) -> float:
    """The level that is white in frames (M, H, W) of whole grey levels: 255, or less where they end sooner.

    A frame that is saturated has no noise, and each pixel its own white: these levels, the brightest, stay as
    they are from frame to frame where others do not. White are those that are more often so than half way
    from the usual to the most.
    """
    if len(frames) < 2 or not np.issubdtype(frames.dtype, np.integer):
        return WHITE_DN
    there, stays = np.zeros((2, int(WHITE_DN) + 1), np.int64)
    for now, later in pairwise(np.minimum(frame, int(WHITE_DN)).ravel() for frame in frames):
        there += np.bincount(now, minlength=there.size)
        stays += np.bincount(now[later == now], minlength=there.size)
    told = np.flatnonzero(there > _FEWEST * there.sum())
    share = stays[told] / there[told]
    order = np.argsort(share)
    weight = np.cumsum(there[told][order])
    usual = share[order][np.searchsorted(weight, weight[-1] / 2)]
    white, most = WHITE_DN, 0.0
    for level, one in zip(told[::-1].tolist(), share[::-1].tolist(), strict=True):
        most = max(most, one)
        if most < max(_FROZEN, _TIMES * usual) or one < (most + usual) / 2:
            break
        white = float(level)
    return white


def is_black(levels: NDArray[Any]) -> NDArray[np.bool_]:
    """Where grey levels (of any shape) do not tell how dark it was."""
    return np.asarray(levels <= ROUNDING_DN)


def is_white(levels: NDArray[Any], white: float) -> NDArray[np.bool_]:
    """Where grey levels (of any shape) do not tell how bright it was; nowhere on a scale beyond 255."""
    if levels.size and levels.max() > WHITE_DN + ROUNDING_DN:
        return np.zeros(levels.shape, np.bool_)
    return np.asarray(levels >= white - ROUNDING_DN)
