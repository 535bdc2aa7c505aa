"""Windows of time: their arithmetic, and what of a recording they leave out, of all rows or row after row."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Windows = NDArray[np.int64]
"""(M, 2) [us]: begin, included, and end, not; in order, none over another."""


def no_windows() -> Windows:
    """(0, 2)."""
    return np.zeros((0, 2), np.int64)


def joined(spans: Iterable[Any], gap_us: int = 0) -> Windows:
    """Spans (begin, end) [us] in any order, as windows: one for those that overlap or lie gap_us apart."""
    result: list[list[int]] = []
    for begin, end in sorted(tuple(span) for span in np.asarray(spans, np.int64).reshape(-1, 2).tolist()):
        if result and begin <= result[-1][1] + gap_us:
            result[-1][1] = max(result[-1][1], end)
        else:
            result.append([begin, end])
    return np.array(result, np.int64).reshape(-1, 2)


def around(t_us: NDArray[np.int64], spans: Windows) -> Windows:
    """Spans (K, 2) [us] about each of the times (N,), joined."""
    return joined((t_us[:, None, None] + spans).reshape(-1, 2))


def number_of(t_us: NDArray[Any], windows: Windows) -> NDArray[np.int64]:
    """(n,): the number of the window that each time lies in, -1 outside all of them."""
    number = np.searchsorted(windows[:, 0], t_us, side="right") - 1
    inside = number >= 0
    inside[inside] = t_us[inside] < windows[number[inside], 1]
    return np.where(inside, number, -1)


def within(t_us: NDArray[Any], windows: Windows) -> NDArray[np.bool_]:
    """(n,): whether each time lies in one of the windows."""
    return number_of(t_us, windows) >= 0


def common(first: Windows, second: Windows) -> Windows:
    """What two have in common, cut at the ends of both."""
    pieces = [
        (max(begin, a), min(end, b))
        for begin, end in first.tolist()
        for a, b in second.tolist()
        if max(begin, a) < min(end, b)
    ]
    return np.array(sorted(pieces), np.int64).reshape(-1, 2)


def complement(windows: Windows) -> Windows:
    """All time before, between and after."""
    ends = np.iinfo(np.int64)
    edges = np.concatenate([[ends.min], windows.ravel(), [ends.max]])
    return edges.reshape(-1, 2)


def total_us(windows: Windows) -> int:
    """Of all of them together [us]."""
    return int(np.diff(windows).sum())


def overlap_us(windows: Windows, edges_us: NDArray[np.int64]) -> NDArray[np.float64]:
    """Time in windows (K, 2) [us] between each two edges (N,), ascending: (N - 1,). Windows that overlap
    count each."""
    inside = np.diff(np.clip(edges_us, windows[:, :1], windows[:, 1:]))  # of windows that may have no end
    return np.asarray(inside.sum(axis=0), np.float64)


@dataclass(frozen=True, eq=False)
class Mask:
    """windows: of all rows. row_windows: of row 0; those of row y are us_per_row * y later."""

    windows: Windows = field(default_factory=no_windows)
    row_windows: Windows = field(default_factory=no_windows)
    us_per_row: float = 0.0

    def start(self, t_us: NDArray[np.float64], y: NDArray[np.int64]) -> NDArray[np.float64]:
        """For events (n,) the start of the window that each lies in; its own time where it lies in none."""
        by_row = _start(t_us, self.row_windows, np.multiply(self.us_per_row, y, dtype=np.float64))
        return np.minimum(_start(t_us, self.windows, np.zeros(1)), by_row)

    def share(self, begin_us: int, end_us: int) -> float:
        """What of a row's time from begin_us to end_us is masked, at most."""
        spans = np.concatenate([self.windows, self.row_windows])
        (lost_us,) = overlap_us(spans, np.array([begin_us, end_us], np.int64))
        return min(float(lost_us) / max(end_us - begin_us, 1), 1.0)

    def from_row(self, row: int) -> Self:
        """The mask of the rows from this one on, counted from it."""
        return replace(self, row_windows=self.row_windows + round(self.us_per_row * row))

    def only(self, windows: Windows) -> Self:
        """The mask that leaves nothing but these windows, less what this one masks."""
        return replace(self, windows=complement(common(windows, complement(self.windows))))


def _start(t_us: NDArray[np.float64], windows: Windows, turn_us: NDArray[np.float64]) -> NDArray[np.float64]:
    """turn_us (n,) or (1,): how much later an event's row has the windows."""
    if len(windows) == 0:
        return t_us
    which = np.maximum(np.searchsorted(windows[:, 0], t_us - turn_us, side="right") - 1, 0)
    begin, end = windows[which, 0] + turn_us, windows[which, 1] + turn_us
    return np.asarray(np.where((t_us >= begin) & (t_us < end), begin, t_us))
