"""B: intervals between events of the same pixel, and how alike two in succession are."""

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import POLARITY, Group, Values, bin_numbers, classes, labels, tally
from voltcam_lab.statistics.setting import Setting
from voltcam_lab.statistics.stream import NONE, EventTable

FINE_MS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 300.0, 1000.0)
COARSE_MS = (1.0, 5.0, 20.0, 100.0, 300.0, 1000.0)
"""For what is rare: nothing in the catalogue showed in finer bins."""
POLARITY_PAIRS = (
    "OFF OFF at rest",
    "OFF ON at rest",
    "ON OFF at rest",
    "ON ON at rest",
    "OFF ON moving",
    "ON OFF moving",
)
_CASE = np.array([0, 1, 2, 3, -1, 4, 5, -1])
"""Number in POLARITY_PAIRS of 4 moving + 2 ON before + ON now."""
RATIO_EDGES = (1.05, 1.15, 1.35, 1.7, 2.5)
FINE_BINS, COARSE_BINS, RATIO_BINS = len(FINE_MS) + 1, len(COARSE_MS) + 1, len(RATIO_EDGES) + 1

_FINE = labels("B", "intervals, moving", "count", POLARITY, ("interval", classes(FINE_MS, "ms")))
_COARSE = labels("B", "intervals", "count", ("pair", POLARITY_PAIRS), ("interval", classes(COARSE_MS, "ms")))
_RATIOS = labels(
    "B", "two intervals in succession, moving", "count", POLARITY, ("ratio", classes(RATIO_EDGES, "to 1"))
)


def observe_inter_event_times(setting: Setting, stream: EventTable) -> Values:
    """Dead time is a hole, noise short opposite pairs; jitter and reset noise make successors unlike."""
    return np.hstack([_fine(stream), _coarse(stream), _ratios(stream)])


def _fine(stream: EventTable) -> Values:
    """Of one polarity, while moving."""
    second = (stream.moving == 1) & (stream.interval_us != NONE) & (stream.on[stream.former] == stream.on)
    index = stream.on * FINE_BINS + _length(stream.interval_us, FINE_MS)
    return tally(stream.part, np.where(second, index, -1), len(_FINE))


def _coarse(stream: EventTable) -> Values:
    """All others."""
    case = _CASE[4 * stream.moving + 2 * stream.on[stream.former] + stream.on]
    index = case * COARSE_BINS + _length(stream.interval_us, COARSE_MS)
    return tally(stream.part, np.where((stream.interval_us == NONE) | (case < 0), -1, index), len(_COARSE))


def _length(interval_us: NDArray[np.int64], edges_ms: tuple[float, ...]) -> NDArray[np.int64]:
    return bin_numbers(interval_us, tuple(1000 * edge for edge in edges_ms))


def _ratios(stream: EventTable) -> Values:
    """Of three events of one polarity while the pixel sees motion."""
    third = stream.thirds
    third = third[stream.moving[third] == 1]
    second = stream.former[third]
    long, short = stream.interval_us[third], stream.interval_us[second]
    ratio = np.maximum(long, short) / np.maximum(np.minimum(long, short), 1)
    index = stream.on[third] * RATIO_BINS + bin_numbers(ratio, RATIO_EDGES)
    return tally(stream.part[third], index, len(_RATIOS))


INTERVALS = Group("B", _FINE + _COARSE + _RATIOS, observe_inter_event_times)
