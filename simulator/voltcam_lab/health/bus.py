"""How long the bus takes for a row and for an event, from stamps and rows alone: where it is never idle.

In a stretch without a gap, its length is the rows that were read times the time of a row, plus the events
times the time of an event. Stretches with few and with many events of a row tell the two apart.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from voltcam_simulator.effect import Events

STRETCH_US = 100
LONGEST_GAP_US = 3  # between two stamps: longer, the bus may have been idle
FEWEST_EVENTS = 100  # of a stretch: fewer leave a camera's bus idle half of the time
FEWEST_STRETCHES = 10


@dataclass(frozen=True)
class Bus:
    """Times of a row and of an event [us]; stretches: how many told of them."""

    row_us: float
    event_us: float
    stretches: int


def find_bus(events: Events) -> Bus | None:
    """None where too few stretches of the recording keep the bus busy."""
    t_us = events["t"]
    if not len(t_us):
        return None
    begins = int(t_us[0]) + STRETCH_US * np.arange((int(t_us[-1]) - int(t_us[0])) // STRETCH_US)
    edges = np.searchsorted(t_us, np.append(begins, begins[-1] + STRETCH_US) if len(begins) else begins)
    full = np.flatnonzero(np.diff(edges) >= FEWEST_EVENTS) if len(edges) else np.zeros(0, np.int64)
    rows, counts, spans = [], [], []
    for k in full:
        part = events[edges[k] : edges[k + 1]]
        gaps = np.diff(part["t"])
        if gaps.max() <= LONGEST_GAP_US:
            changes = (gaps > 0) | (np.diff(part["y"].astype(np.int64)) != 0)
            rows.append(np.count_nonzero(changes))
            counts.append(len(part) - 1)
            spans.append(int(part["t"][-1] - part["t"][0]))
    if len(spans) < FEWEST_STRETCHES:
        return None
    times, _ = nnls(np.column_stack([rows, counts]).astype(np.float64), np.array(spans, np.float64))
    return Bus(float(times[0]), float(times[1]), len(spans))
