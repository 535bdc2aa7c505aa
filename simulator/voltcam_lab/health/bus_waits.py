"""How long a bus that was idle takes to begin, and a row to ask for it: from stamps and rows alone.

Rows that ask at random and are served one after the other are the queue M/G/1, with a setup time where it was
idle (P. D. Welch, Oper. Res. 12, 1964; H. Takagi, Queueing Analysis 1, 1991). With L readings a second,
service times s and setups of mean D, a reading leaves nothing behind with the probability
(1 - L s)/(1 + L D). Then the next one comes after s, an exponential time of mean 1/L, and a setup.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.optimize import brentq, minimize_scalar
from scipy.special import xlogy

from voltcam_simulator.effect import Events

from .token_scan import COHERENT, WINDOW_US, Windows

APART_US = 2  # stamps of two readings that did not follow at once: a stamp is 1 us
FEWEST = 60  # readings of a window: with fewer the bus is idle nearly always
FEWEST_WINDOWS = 50
MOST_EVENTS = 1.3  # of a reading: more are bursts, in which rows do not ask at random
LONGEST_US = 40  # a row's times from event to event; after longer ones rows ask as they did before
LEAST_US, MOST_US = 0.05, 100.0  # waits that are looked for
CLEAR_SD = 8.0  # standard deviations by which more readings follow at once than without a setup
CLEAR_GAIN = 50.0  # twice the log likelihood of a wait
STEPS = 20  # of an integral over a microsecond

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class BusWaits:
    """Means of exponential times [us]: start_us of a bus that was idle, row_us from a row's first event to
    its request. 0: none is to be seen."""

    start_us: float = 0.0
    row_us: float = 0.0


def find_waits(events: Events, height: int, row_us: float, event_us: float) -> BusWaits:
    """row_us, event_us: what the bus takes for a row and for an event of it."""
    if not len(events):
        return BusWaits()
    start_us = _start_us(events, height, row_us, event_us)
    # A row waits for its own request and then for the bus to begin.
    return BusWaits(start_us, max(row_wait_us(events) - start_us, 0.0))


def apart(per_us: Vector, service_us: Vector, start_us: float) -> Vector:
    """Probability that the next reading's stamp, in whole microseconds, is APART_US later or more."""
    spent_us = np.linspace(APART_US - 1, APART_US, STEPS + 1)[:, None] - service_us  # since the bus was free
    spent_us = np.maximum(spent_us, 0.0)
    begins = 1 / start_us
    still = (begins * np.exp(-per_us * spent_us) - per_us * np.exp(-begins * spent_us)) / (begins - per_us)
    idle = (1 - per_us * service_us) / (1 + per_us * start_us)
    return np.asarray(idle * still.mean(axis=0))


def _start_us(events: Events, height: int, row_us: float, event_us: float) -> float:
    windows = Windows.of(events, height)
    token = np.asarray(binary_dilation(windows.coherence > COHERENT, np.ones(3)), np.bool_)
    t_us, y = events["t"].astype(np.int64), events["y"].astype(np.int64)
    first = np.flatnonzero(np.r_[True, (np.diff(t_us) != 0) | (np.diff(y) != 0)])
    where = (t_us[first] - windows.edges_us[0]) // WINDOW_US
    inside = where < len(token)
    where = where[inside]
    readings = np.bincount(where, minlength=len(token))
    later = np.append(np.diff(t_us[first]) >= APART_US, False)[inside]
    seen = np.bincount(where, later, minlength=len(token))
    used = ~token & (readings >= FEWEST) & (windows.counts < MOST_EVENTS * readings)
    service_us = row_us + event_us * windows.counts[used] / readings[used]
    per_us = readings[used] / WINDOW_US
    if used.sum() < FEWEST_WINDOWS or np.any(per_us * service_us >= 1):
        return 0.0

    def missing(start_us: float) -> float:
        expected = readings[used] * apart(per_us, service_us, start_us)
        return float(expected.sum() - seen[used].sum())

    share = seen[used].sum() / readings[used].sum()
    if missing(LEAST_US) < CLEAR_SD * np.sqrt(readings[used].sum() * share * (1 - share)):
        return 0.0
    most_us = 0.9 / float(per_us.max())
    if missing(most_us) >= 0:
        return most_us
    found: Any = brentq(missing, LEAST_US, most_us)
    return float(found)


def row_wait_us(events: Events) -> float:
    """Likeliest mean of an exponential time in which no second reading of the row comes [us]. 0 where it is
    not clear, or tells less of these times than is left to tell."""
    order = np.argsort(events["y"], kind="stable")
    t_us, y = events["t"][order].astype(np.int64), events["y"][order].astype(np.int64)
    times_us = np.diff(t_us)[np.diff(y) == 0]
    us = np.arange(1, LONGEST_US + 1)
    counts = np.bincount(times_us[(times_us > 0) & (times_us <= LONGEST_US)], minlength=LONGEST_US + 1)[1:]

    def unlikely(log_us: float) -> float:
        shape = -np.expm1(-us / np.exp(log_us))
        return -2 * float(counts @ np.log(shape / shape.sum()))

    ends = np.log(LEAST_US), np.log(MOST_US)
    found: Any = minimize_scalar(unlikely, bounds=ends, method="bounded")
    gain = unlikely(ends[0]) - found.fun
    left = found.fun + 2 * float(xlogy(counts, counts / max(counts.sum(), 1)).sum())
    return float(np.exp(found.x)) if gain > max(CLEAR_GAIN, left) else 0.0
