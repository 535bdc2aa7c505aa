"""LightStrata: how bright a pixel is, and how its brightness changes, over each step of the scene."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.kernel import kernel

from ..light.still import still_steps

INTENSITY_NAMES = ("darkest", "dark", "middle", "bright", "brightest")
SLOPE_NAMES = ("falling fast", "falling", "lull", "rising", "rising fast", "rest")
INTENSITIES, SLOPES = len(INTENSITY_NAMES), len(SLOPE_NAMES)
LULL, REST = 2, 5
"""Lull: constant now, but not before or soon. Rest: constant for longer."""

_SHARES = (
    0.1,
    0.3,
    0.55,
    0.8,
)  # of pixels and time below each edge: the dark, where noise is, in finer steps
_LULL_SHARE = 0.1  # of the speed that divides slow from fast


@dataclass(frozen=True, eq=False)
class LightStrata:
    """index (N - 1, K) uint8: intensity class x SLOPES + slope class of each step and pixel."""

    index: NDArray[np.uint8]
    intensity_edges_dn: NDArray[np.float64]
    fast_per_s: float
    """|d ln(L + k2)/dt| above which half of the change of brightness happens [1/s]."""


def light_strata(
    light: NDArray[np.float32], log_light: NDArray[np.float32], t_us: NDArray[np.int64]
) -> LightStrata:
    """LightStrata of K pixels at N instants: light (N, K) [DN], log_light (N, K), t_us (N,)."""
    some = slice(None), slice(None, None, max(1, light.size // 2_000_000))
    edges_dn = np.quantile(light[some], _SHARES).astype(np.float64)
    edges = np.interp(edges_dn, np.sort(light[some], axis=None), np.sort(log_light[some], axis=None))
    resting = np.ascontiguousarray(still_steps(np.ascontiguousarray(log_light.T), t_us).T)
    moves = ~resting[some]
    change = np.abs(np.diff(log_light[some], axis=0))[moves]
    span_s = np.broadcast_to(np.diff(t_us)[:, None] * 1e-6, moves.shape)[moves]
    fast_per_s = weighted_median(change / span_s, change) if change.sum() > 0 else 1.0
    index = np.empty(resting.shape, np.uint8)
    classify(log_light, t_us, edges, fast_per_s, _LULL_SHARE * fast_per_s, resting, SLOPES, index)
    return LightStrata(index, edges_dn, fast_per_s)


def weighted_median(values: NDArray[Any], weights: NDArray[Any]) -> float:
    """The value that half of the weight lies below."""
    order = np.argsort(values)
    weight = np.cumsum(weights[order], dtype=np.float64)
    return float(values[order][np.searchsorted(weight, weight[-1] / 2)])


@kernel
def classify(
    log_light: Any, t_us: Any, edges: Any, fast: Any, lull: Any, resting: Any, slopes: Any, index: Any
) -> None:
    """Fill index; edges of ln(L + k2); fast and lull: limits of slope [1/s]; rest is the last class."""
    for s in range(index.shape[0]):
        for k in range(index.shape[1]):
            middle = 0.5 * (log_light[s, k] + log_light[s + 1, k])
            intensity = 0
            for edge in edges:
                intensity += middle > edge
            slope = (log_light[s + 1, k] - log_light[s, k]) / ((t_us[s + 1] - t_us[s]) * 1e-6)
            speed = abs(slope)
            kind = 2 if speed < lull else (3 if speed < fast else 4)
            if slope < 0:
                kind = 4 - kind
            index[s, k] = intensity * slopes + (slopes - 1 if resting[s, k] else kind)
