"""Whether rows take turns: events that run over the rows after each frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .subject import Subject

_SHUFFLES = 19
_BEGINS = (0.0, 0.25, 0.5, 0.75)  # of bins, in their width


@dataclass(frozen=True)
class RowScan:
    """Rows follow one another every us_per_row (negative: upwards)."""

    us_per_row: float
    score: float


def without_delay_us(subject: Subject, scan: RowScan) -> NDArray[np.int64]:
    """(n,): since the nearest frame, less the delay of the event's row: bursts are narrow and stand out."""
    half_us = subject.period_us / 2
    straight = (subject.since_frame_us - scan.us_per_row * subject.y + half_us) % (2 * half_us) - half_us
    return straight.astype(np.int64)


def find_row_scan(subject: Subject, chosen: NDArray[np.bool_]) -> RowScan | None:
    """How the chosen events run over the rows after each frame, if they do: the slope that makes their times
    after the frame fall together best, against the same events with their rows exchanged."""
    events = np.flatnonzero(chosen & (subject.nearest_frame >= 0))
    events = events[:: max(1, events.size // 5000)]
    if events.size < 200:
        return None
    t, y = subject.since_frame_us[events].astype(np.float64), subject.y[events].astype(np.float64)
    period_us, rows = subject.period_us, subject.footage.height
    steepest = 1.1 * period_us / rows
    slopes = np.arange(-steepest, steepest, 250 / rows)

    def gathered(y: NDArray[np.float64], slopes: NDArray[np.float64], width_us: float) -> NDArray[np.float64]:
        """How much falls together in bins of a width, wherever they begin."""
        bins = int(period_us // width_us)
        places = (t - slopes[:, None] * y) % period_us * bins / period_us
        counts = [[np.bincount((at + begin).astype(np.int64) % bins) for begin in _BEGINS] for at in places]
        return np.array([sum(float(np.sum(count**2.0)) for count in one) for one in counts], np.float64)

    scores = gathered(y, slopes, 250)
    rng = np.random.default_rng(0)
    null = np.array([gathered(rng.permutation(y), slopes, 250).max() for _ in range(_SHUFFLES)])
    score = float((scores.max() - null.mean()) / max(null.std(ddof=1), 1e-9))
    if score < 6:
        return None
    fine = slopes[int(np.argmax(scores))] + np.linspace(-1, 1, 81) * 500 / rows
    slope = float(fine[int(np.argmax(gathered(y, fine, 100)))])
    return RowScan(slope, score) if abs(slope) * rows > 500 else None
