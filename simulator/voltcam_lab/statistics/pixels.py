"""C: pixels that differ from the others, and whether they do so again.

Each pixel's events are counted in two halves of a part (every other of its time blocks), and held against
what the scene makes of it: its share of all rises of brightness for ON while moving, of falls for OFF, of
time for those at rest. The products of both halves' scores, summed over the pixels of a part, are 0 unless
what makes pixels differ is still there in the other half.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import Group, Values, labels
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable
from voltcam_simulator.kernel import kernel

KINDS = ("ON moving", "OFF moving", "ON at rest", "OFF at rest")
_PATH = (0, 1, 2, 2)  # which row of Setting.path each kind goes by
PRODUCTS = ((0, 0), (1, 1), (0, 1), (2, 2), (3, 3), (2, 3), (0, 2))
HIGH, LOW = (4.0, 8.0, 16.0), (-1.5, -2.5)
_CLIP = 4.0  # a hot pixel must not drown the others

_LABELS = (
    *labels(
        "C",
        "differs twice",
        "value",
        ("kinds", tuple(f"{KINDS[i]} x {KINDS[j]}" for i, j in PRODUCTS)),
        floor=4.0,
    ),
    *labels("C", "spread over pixels", "value", ("kind", KINDS), floor=4.0),
    *labels("C", "pixels far above", "count", ("kind", KINDS[::2]), ("score", tuple(f"{s:g}" for s in HIGH))),
    *labels("C", "pixels far below", "count", ("kind", KINDS[:2]), ("score", tuple(f"{s:g}" for s in LOW))),
)


def observe_pixels(setting: Setting, stream: EventTable) -> Values:
    """Mismatch lasts and shows while moving; leak spread at rest; hot pixels stand out."""
    stream = stream.settled
    n = counts(stream, len(setting.pixels))
    tile = setting.tiles.ravel()[setting.pixels]
    rows = []
    for part in range(PARTS):
        mine = tile == part % 2
        halves = [part // 2, part // 2 + 2]
        rows.append(_of_part(n[halves][:, :, mine], setting.path[halves][:, :, mine]))
    return np.array(rows)


@kernel
def _count(quarter: Any, kind: Any, place: Any, n: Any) -> None:
    for i in range(quarter.size):
        n[quarter[i], kind[i], place[i]] += 1


def counts(stream: EventTable, pixels: int) -> NDArray[np.float64]:
    """(4 blocks modulo 4, KINDS, K) events of each kept pixel."""
    n = np.zeros((4, len(KINDS), pixels))
    _count(stream.quarter, 3 - 2 * stream.moving - stream.on, stream.place, n)
    return n


def expected(n: NDArray[np.float64], path: NDArray[np.float64]) -> NDArray[np.float64]:
    """All events of each kind, (..., KINDS, K), dealt out by each pixel's path, (..., 3, K)."""
    way = path[..., _PATH, :]
    share = way / np.maximum(way.sum(axis=-1, keepdims=True), 1e-9)
    wanted: NDArray[np.float64] = n.sum(axis=-1, keepdims=True) * share
    return wanted


def pixel_scores(n: NDArray[np.float64], e: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far above expectation, about 1 in spread where events come at random."""
    score: NDArray[np.float64] = (n - e) / np.sqrt(e + 1)
    return score


def _of_part(n: NDArray[np.float64], path: NDArray[np.float64]) -> NDArray[np.float64]:
    """The statistics of one part; n (2 halves, KINDS, pixels), path (2, 3, pixels)."""
    e = expected(n, path)
    d = np.clip(pixel_scores(n, e), -_CLIP, _CLIP)
    products = [(d[0, i] * d[1, j] + d[0, j] * d[1, i]).sum() / 2 for i, j in PRODUCTS]
    n, e = n.sum(axis=0), e.sum(axis=0)
    whole = pixel_scores(n, e)
    spread = (np.clip(whole, -_CLIP, _CLIP) ** 2).sum(axis=1)
    high = [(one > limit).sum() for one in whole[::2] for limit in HIGH]
    low = [(one < limit).sum() for one in whole[:2] for limit in LOW]
    return np.array([*products, *spread, *high, *low])


PIXELS = Group("C", _LABELS, observe_pixels)
