"""Pixels that fire too often, or never, by their neighbours and by the light they saw.

A pixel's count is compared with what the eight around it have (the second largest, or the second smallest, so
that a neighbour at fault itself does no harm), by a negative binomial: Poisson with a gain that differs from
pixel to pixel. A pixel is named when its count has a probability below ERROR / pixels: of healthy sensors, at
most ERROR lose a pixel.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import rank_filter
from scipy.stats import nbinom

ERROR = 0.01
HOT_SPREAD = 0.5  # of the gain, relative: wide, because edges of the scene fall between pixels
SILENT_SPREAD = 0.3

_AROUND = np.ones((3, 3), np.bool_)
_AROUND[1, 1] = False


def find_hot(counts: NDArray[np.int64], change: NDArray[np.float32]) -> NDArray[np.bool_]:
    """counts, change of ln L: (H, W). Pixels far above their neighbours and what their light explains."""
    explained = change * _gain(counts, change)
    level = max(0.5, float(np.mean(np.minimum(counts, np.quantile(counts, 0.99)))) / 10)
    hot = np.zeros(counts.shape, np.bool_)
    cleaned = counts.astype(np.float64)
    for _ in range(4):  # hot ones hide others beside them
        second_largest = rank_filter(cleaned, -2, footprint=_AROUND, mode="reflect")
        expected = np.maximum(np.maximum(second_largest, explained), level)
        found = _tail(counts, expected, HOT_SPREAD) < ERROR / counts.size
        if not (found & ~hot).any():
            break
        hot |= found
        cleaned[hot] = np.minimum(cleaned, rank_filter(cleaned, 3, footprint=_AROUND, mode="reflect"))[hot]
    return hot


def find_silent(counts: NDArray[np.int64], change: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(H, W): pixels without an event, where the light changed and the neighbours told of it."""
    second_smallest = rank_filter(counts.astype(np.float64), 1, footprint=_AROUND, mode="reflect")
    expected = np.minimum(second_smallest, change * _gain(counts, change))
    shape = 1 / SILENT_SPREAD**2
    none = (1 + expected / shape) ** -shape
    silent: NDArray[np.bool_] = (counts == 0) & (none < ERROR / counts.size)
    return silent


def _gain(counts: NDArray[np.int64], change: NDArray[np.float32]) -> float:
    """Events per change of ln L, of pixels that saw more change than most."""
    seen = change > max(0.1, float(np.quantile(change, 0.5)))
    return float(np.median(counts[seen] / change[seen])) if seen.any() else 0.0


def _tail(counts: NDArray[np.int64], expected: NDArray[np.float64], spread: float) -> NDArray[np.float64]:
    """P(a count is this or more)."""
    shape = 1 / spread**2
    tail: NDArray[np.float64] = nbinom.sf(counts - 1, shape, shape / (shape + expected))
    return tail
