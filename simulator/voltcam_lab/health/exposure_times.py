"""When exposures begin and how long they are, as the file says it or as events tell."""

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

SHORTEST_US = 50.0  # below, the crowds of begin and end are one
NEAR_US = 100


def exposure_times(
    events: Events, frame_t_us: NDArray[np.int64], exposure_us: NDArray[np.int64] | None, row_us: float
) -> tuple[float, float | None]:
    """(begin of some exposure [us], length [us]; None where events do not tell it).

    exposure_us: (N, 2), where the file says it. Events of one polarity crowd in the frame's phase at the
    begin, those of the other at the end, less than half a period later. OFF events do so at once or row
    after row (row_us), whichever crowd is sharper.
    """
    if exposure_us is not None:
        return float(exposure_us[0, 0]), float(np.median(exposure_us[:, 1] - exposure_us[:, 0]))
    period_us, origin_us = float(np.median(np.diff(frame_t_us))), float(frame_t_us[0])
    since_us, on = events["t"] - origin_us, events["p"]
    begin, _ = crowd(since_us[on], period_us)
    off_us, row = since_us[~on], events["y"][~on]
    end, _ = max(
        (crowd(off_us - per_row_us * row, period_us) for per_row_us in (0.0, row_us)), key=lambda one: one[1]
    )
    length_us = (end - begin) % 1.0 * period_us
    if length_us > period_us / 2:  # a line that goes down for the exposure: OFF events come first
        begin, length_us = end, period_us - length_us
    told = length_us > SHORTEST_US
    return origin_us + begin * period_us, length_us if told else None


def crowd(t_us: NDArray[np.float64], period_us: float) -> tuple[float, int]:
    """The phase (0 to 1) of a period at which most events come, and how many come within NEAR_US of it."""
    bins = max(8, int(period_us / NEAR_US))
    phase = (t_us % period_us) / period_us
    counts = np.bincount((phase * bins).astype(np.int64), minlength=bins)
    fullest = (int(np.argmax(counts)) + 0.5) / bins
    beside = (phase - fullest + 0.5) % 1.0 - 0.5
    near = beside[np.abs(beside) < 1 / bins]
    return fullest + (float(np.median(near)) if near.size else 0.0), int(counts.max())
