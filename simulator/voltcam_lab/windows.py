"""Times to leave out of a recording: for all rows at once, or for one row after the other."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Windows = NDArray[np.int64]
"""(M, 2) [us]: begin, included, and end, not; in order and apart."""


def _none() -> Windows:
    return np.zeros((0, 2), np.int64)


@dataclass(frozen=True, eq=False)
class Mask:
    """windows: of all rows. row_windows: of row 0; those of row y are us_per_row * y later."""

    windows: Windows = field(default_factory=_none)
    row_windows: Windows = field(default_factory=_none)
    us_per_row: float = 0.0

    def start(self, t_us: NDArray[np.float64], y: NDArray[np.int64]) -> NDArray[np.float64]:
        """For events (n,) the start of the window that each lies in; its own time where it lies in none."""
        by_row = _start(t_us, self.row_windows, np.multiply(self.us_per_row, y, dtype=np.float64))
        return np.minimum(_start(t_us, self.windows, np.zeros(1)), by_row)

    def share(self, begin_us: int, end_us: int) -> float:
        """What of a row's time from begin_us to end_us is masked, at most."""
        spans = np.concatenate([self.windows, self.row_windows])
        lost = np.clip(spans[:, 1], begin_us, end_us) - np.clip(spans[:, 0], begin_us, end_us)
        return min(float(lost.sum()) / max(end_us - begin_us, 1), 1.0)


def _start(t_us: NDArray[np.float64], windows: Windows, turn_us: NDArray[np.float64]) -> NDArray[np.float64]:
    if len(windows) == 0:
        return t_us
    which = np.maximum(np.searchsorted(windows[:, 0], t_us - turn_us, side="right") - 1, 0)
    begin, end = windows[which, 0] + turn_us, windows[which, 1] + turn_us
    return np.asarray(np.where((t_us >= begin) & (t_us < end), begin, t_us))
