"""I: what events of neighbouring pixels have to do with each other; rows, columns, radius."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import MOTION, POLARITY, Group, Values, classes, labels, tally
from voltcam_lab.statistics.pixels import counts, expected, pixel_scores
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable
from voltcam_simulator.kernel import kernel

EDGES_MS = (0.002, 0.2, 1.0, 5.0)
LAG_BINS = len(EDGES_MS)  # what is later than the last is left out
RINGS = 3
_PAIR = ("neighbour", ("other polarity", "same polarity"))
_LINES = ("lines", ("rows", "columns"))
_KINDS = ("kind", ("moving", "at rest"))

_LABELS = (
    *labels("I", "a neighbour just before", "count", MOTION, _PAIR, ("lag", classes(EDGES_MS, "ms")[:-1])),
    *labels(
        "I", "events by distance from the centre", "count", POLARITY, ("ring", ("inner", "middle", "outer"))
    ),
    *labels("I", "spread over lines", "value", _LINES, _KINDS, floor=4.0),
)


def observe_neighbours(setting: Setting, stream: EventTable) -> Values:
    """Crosstalk: a neighbour fires too, at rest as well. Rows that differ: the readout. Rings: the lens."""
    settled = stream.settled
    rings = ring_of(setting)[settled.pixel]
    return np.hstack([
        _neighbours(setting, stream),
        tally(settled.part, settled.on * RINGS + rings, 2 * RINGS),
        _lines(setting, settled),
    ])  # fmt: skip


def _neighbours(setting: Setting, stream: EventTable) -> Values:
    size = len(_LABELS) - 2 * RINGS - 4
    edges_us = np.array(EDGES_MS) * 1000
    table = np.zeros((PARTS, size))
    kind = 2 * stream.moving
    count_neighbours(
        stream.t_us, stream.pixel, stream.on, stream.part, kind, setting.scene.width, setting.scene.height,
        edges_us, table,
    )  # fmt: skip
    return table


@kernel
def count_neighbours(
    t_us: Any, pixel: Any, on: Any, part: Any, kind: Any, width: Any, height: Any, edges_us: Any, table: Any
) -> None:
    """For each event and neighbour (of 4) whose last event is less than edges_us[-1] old: one in the table.

    Events of one stamp are all there before any is looked at, so that their order does not matter.
    """
    last = np.full(width * height, -1 << 60, np.int64)
    sign = np.zeros(width * height, np.int64)
    head = 0
    for i in range(t_us.size):
        while head < t_us.size and t_us[head] == t_us[i]:
            last[pixel[head]], sign[pixel[head]] = t_us[head], on[head]
            head += 1
        y, x = pixel[i] // width, pixel[i] % width
        for dy, dx in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            v, u = y + dy, x + dx
            if v < 0 or v >= height or u < 0 or u >= width:
                continue
            age = t_us[i] - last[v * width + u]
            if age >= edges_us[-1]:
                continue
            lag = 0
            while age >= edges_us[lag]:
                lag += 1
            table[part[i], (kind[i] + (sign[v * width + u] == on[i])) * edges_us.size + lag] += 1


def ring_of(setting: Setting) -> NDArray[np.int64]:
    """(H W,) 0 to RINGS - 1: equal areas of the circle around the image."""
    height, width = setting.scene.height, setting.scene.width
    y, x = np.indices((height, width))
    r2 = ((y + 0.5) / height - 0.5) ** 2 + ((x + 0.5) / width - 0.5) ** 2
    rank = np.argsort(np.argsort(r2, axis=None, kind="stable"), kind="stable")
    return rank * RINGS // r2.size


def _lines(setting: Setting, stream: EventTable) -> Values:
    """Sum over rows and over columns of the squared score of their events, moving and at rest."""
    n, path = counts(stream, len(setting.pixels)), setting.path
    n, path = n[:2] + n[2:], path[:2] + path[2:]
    tile = setting.tiles.ravel()[setting.pixels]
    y, x = np.divmod(setting.pixels, setting.scene.width)
    rows = []
    for part in range(PARTS):
        mine = tile == part % 2
        mine_n = n[part // 2][:, mine]
        mine_e = expected(mine_n, path[part // 2][:, mine])
        by_kind = [array.reshape(2, 2, -1).sum(axis=1) for array in (mine_n, mine_e)]
        rows.append([_spread(line[mine], *pair) for line in (y, x) for pair in zip(*by_kind, strict=True)])
    return np.array(rows)


def _spread(line: NDArray[np.int64], n: NDArray[np.float64], e: NDArray[np.float64]) -> float:
    observed, wanted = _by_line(line, n), _by_line(line, e)
    return float((pixel_scores(observed, wanted) ** 2).sum())


def _by_line(line: NDArray[np.int64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.bincount(line, weight).astype(np.float64)


NEIGHBOURS = Group("I", _LABELS, observe_neighbours)
