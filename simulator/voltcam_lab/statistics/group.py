"""What a group of statistics is, and how it counts."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable
from voltcam_simulator.kernel import kernel

Kind = Literal["count", "value"]
Values = NDArray[np.float64]


@dataclass(frozen=True)
class Label:
    """What an entry of an observation is."""

    group: str
    """The letter."""
    name: str
    kind: Kind
    """count: a number of events or pixels, to be compared as 2 sqrt(n + 3/8). value: as it is."""
    floor: float
    """About what a single event or pixel makes of it, in the units of comparison: no twin's spread is to be
    taken for less, or what is nearly always 0 would raise the alarm when for once it is not."""
    strata: tuple[tuple[str, str], ...]
    """(what, which) pairs, ("polarity", "ON")."""

    def __str__(self) -> str:
        which = ", ".join(f"{key} {value}" for key, value in self.strata)
        return f"{self.group} {self.name}" + (f" ({which})" if which else "")


@dataclass(frozen=True)
class Group:
    """Statistics of one idea: their labels, and how to take them, (PARTS, len(labels)) of a stream.

    in_any_light: of events whose light between frames need not be known, as what it did says nothing else.
    """

    letter: str
    labels: tuple[Label, ...]
    observe: Callable[[Setting, EventTable], Values]
    in_any_light: bool = False


POLARITY = ("polarity", ("OFF", "ON"))
MOTION = ("motion", ("rest", "moving"))


def labels(
    group: str, name: str, kind: Kind, *axes: tuple[str, tuple[str, ...]], floor: float = 1.0
) -> tuple[Label, ...]:
    """One label for each place of a table with these axes, (name, classes), the last one fastest."""
    cells: list[tuple[tuple[str, str], ...]] = [()]
    for axis, classes in axes:
        cells = [(*cell, (axis, one)) for cell in cells for one in classes]
    return tuple(Label(group, name, kind, floor, cell) for cell in cells)


def classes(edges: tuple[float, ...], unit: str) -> tuple[str, ...]:
    """Names of the bins that `bin_numbers` numbers."""
    inner = [f"{low:g} to {high:g} {unit}" for low, high in pairwise(edges)]
    return (f"below {edges[0]:g} {unit}", *inner, f"from {edges[-1]:g} {unit}")


def bin_numbers(x: NDArray[Any], edges: tuple[float, ...]) -> NDArray[np.int64]:
    """(n,) how many edges each is at or above, as np.searchsorted counts, but faster for a few edges."""
    bins = np.zeros(x.size, np.int64)
    _bin(x, np.array(edges, np.float64), bins)
    return bins


def tally(part: NDArray[Any], index: NDArray[Any], size: int) -> Values:
    """(PARTS, size) how often each index is there; negative ones are left out."""
    table = np.zeros((PARTS, size))
    _count(part, index, table)
    return table


def sums(part: NDArray[Any], index: NDArray[Any], weight: NDArray[Any], size: int) -> Values:
    """(PARTS, size) sum of the weights of each index; negative ones are left out."""
    table = np.zeros((PARTS, size))
    _add(part, index, weight, table)
    return table


@kernel
def _bin(x: Any, edges: Any, bins: Any) -> None:
    for edge in edges:
        for i in range(x.size):
            bins[i] += x[i] >= edge


@kernel
def _count(part: Any, index: Any, table: Any) -> None:
    for i in range(index.size):
        if index[i] >= 0:
            table[part[i], index[i]] += 1


@kernel
def _add(part: Any, index: Any, weight: Any, table: Any) -> None:
    for i in range(index.size):
        if index[i] >= 0:
            table[part[i], index[i]] += weight[i]
