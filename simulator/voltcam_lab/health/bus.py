"""How a bus reads events, from their stamps and rows alone: where it is never idle.

In a stretch without a gap, its length is the rows that were read times the time of a row, plus the events
times the time of an event. Stretches with few and with many events of a row tell the two apart. Events of a
row, or of a column, have one stamp; in which order rows leave tells the arbiter.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from voltcam_simulator.effect import Events
from voltcam_simulator.effects.readout import Arbiter

from .arbiter_order import arbiter_of
from .bus_waits import BusWaits, find_waits

Along = Literal["rows", "columns"]
STRETCH_US = 100
LONGEST_GAP_US = 3  # between two stamps: longer, the bus may have been idle
FEWEST_EVENTS = 100  # of a stretch: fewer leave a camera's bus idle half of the time
FEWEST_STRETCHES = 10


@dataclass(frozen=True)
class Bus:
    """Times of a row (or column), of an event, and in which a token passes a row [us]; what is read at a
    time, in which order; stretches: how many told of them. waits: of the bus and of a row, where it reads
    rows."""

    row_us: float
    event_us: float
    pass_us: float
    along: Along
    arbiter: Arbiter
    stretches: int
    waits: BusWaits


def find_bus(events: Events, height: int, width: int) -> Bus | None:
    """None where too few stretches of the recording keep the bus busy."""
    stretches = busy_stretches(events)
    if len(stretches) < FEWEST_STRETCHES:
        return None
    along: Along = "rows" if _together(stretches, "y") >= _together(stretches, "x") else "columns"
    groups = height if along == "rows" else width
    orders = [_order(part, "y" if along == "rows" else "x") for part in stretches]
    arbiter = arbiter_of(orders, groups)
    columns = [[len(order) - 1 for order in orders], [len(part) - 1 for part in stretches]]
    if arbiter == "token":
        ways = [np.diff(order) % groups for order in orders]  # to the same row once more: none
        columns.append([int((way - (way > 0)).sum()) for way in ways])
    spans = [int(part["t"][-1] - part["t"][0]) for part in stretches]
    times, _ = nnls(np.array(columns, np.float64).T, np.array(spans, np.float64))
    row_us, event_us, pass_us = [*times.tolist(), 0.0][:3]
    waits = find_waits(events, height, row_us, event_us) if along == "rows" else BusWaits()
    return Bus(row_us, event_us, pass_us, along, arbiter, len(stretches), waits)


def busy_stretches(events: Events) -> list[Events]:
    """The events of each stretch in which the bus is never idle."""
    t_us = events["t"]
    count = (int(t_us[-1]) - int(t_us[0])) // STRETCH_US if len(t_us) else 0
    if count < 1:
        return []
    edges = np.searchsorted(t_us, int(t_us[0]) + STRETCH_US * np.arange(count + 1))
    full = [events[edges[k] : edges[k + 1]] for k in np.flatnonzero(np.diff(edges) >= FEWEST_EVENTS)]
    return [part for part in full if np.diff(part["t"]).max() <= LONGEST_GAP_US]


def _together(stretches: list[Events], axis: str) -> int:
    """Events that share stamp and row (or column) with the one before."""
    return sum(
        int(np.count_nonzero((np.diff(part["t"]) == 0) & (np.diff(part[axis].astype(np.int64)) == 0)))
        for part in stretches
    )


def _order(part: Events, axis: str) -> NDArray[np.int64]:
    """Rows (or columns) as they leave."""
    groups = part[axis].astype(np.int64)
    begins = np.concatenate([[True], (np.diff(part["t"]) > 0) | (np.diff(groups) != 0)])
    return np.asarray(groups[begins])
