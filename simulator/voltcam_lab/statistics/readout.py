"""D: the bus that all pixels share: intervals of the whole array, bursts, shared stamps, the clock."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.statistics.group import Group, Values, bin_numbers, classes, labels, tally
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable
from voltcam_simulator.kernel import kernel

GAPS_US = (2, 5, 10, 15, 25, 40, 60, 100, 200, 500, 1000, 3000, 10_000)
ROW_GAPS_US = (5, 10, 20, 40, 80, 200)
WINDOW_US = 250
HOLE_US = 1000
HOLES = (3.0, 8.0)
CROWDS = (2, 4, 8, 16, 32, 64)
MODULI = ((512, (2, 4, 8, 16, 32, 64, 128, 256, 512)), (3000, (3, 5, 10, 100, 1000)))
"""(a common multiple, divisors of it) [us]."""

_LABELS = (
    *labels("D", "time since the array's last stamp", "count", ("gap", classes(GAPS_US, "us"))),
    *labels("D", "time since the row's last stamp", "count", ("gap", classes(ROW_GAPS_US, "us"))),
    *labels("D", "crowd within 250 us", "count", ("crowd", classes(CROWDS, "events"))),
    *labels("D", "shares its stamp", "count", ("with", ("another row", "its row"))),
    *labels("D", "silent milliseconds", "count", ("expected events", tuple(f"{n:g}" for n in HOLES))),
    *labels("D", "t divisible", "count", ("by", tuple(f"{m} us" for _, all_m in MODULI for m in all_m))),
)


def observe_readout(setting: Setting, stream: EventTable) -> Values:
    """A busy bus leaves no short gaps between pixels; overflow leaves long ones; a clock has ticks."""
    part, t_us, row = stream.part, stream.t_us, stream.pixel // setting.scene.width
    gap = bin_numbers(since(t_us, np.zeros_like(row), 1), GAPS_US)
    row_gap = bin_numbers(since(t_us, row, setting.scene.height), ROW_GAPS_US)
    crowd = bin_numbers(runs(t_us // WINDOW_US), CROWDS)
    return np.hstack([
        tally(part, gap, len(GAPS_US) + 1),
        tally(part, row_gap, len(ROW_GAPS_US) + 1),
        tally(part, crowd, len(CROWDS) + 1),
        tally(part, shared(t_us, row, setting.scene.height), 2),
        holes(setting, stream),
        ticks(part, t_us),
    ])  # fmt: skip


def shared(t_us: NDArray[np.int64], row: NDArray[np.int32], height: int) -> NDArray[np.int64]:
    """1 for an event that shares its stamp with one of its row, 0 with others only, -1 with none."""
    alone, alone_in_row = runs(t_us) == 1, runs(t_us * height + row) == 1
    return np.where(alone, -1, np.where(alone_in_row, 0, 1))


def holes(setting: Setting, stream: EventTable) -> Values:
    """(PARTS, HOLES) milliseconds without an event of a tile's pixels, though light changed enough."""
    edges_us = np.arange(setting.block_edges_us[0], setting.block_edges_us[-1], HOLE_US)
    block = np.searchsorted(setting.block_edges_us, edges_us[:-1], side="right") - 1
    hole = (stream.t_us - edges_us[0] - 1) // HOLE_US
    table = np.zeros((PARTS, len(HOLES)))
    for tile, bustle in enumerate(setting.bustle):
        wanted = setting.parameters.contrast_response.k1 * np.diff(
            np.interp(edges_us, setting.scene.t_us, bustle)
        )
        silent = np.bincount(hole[stream.part % 2 == tile], minlength=len(edges_us))[: len(wanted)] == 0
        for k, least in enumerate(HOLES):
            table[:, k] += np.bincount(2 * (block[silent & (wanted >= least)] % 2) + tile, minlength=PARTS)
    return table


def ticks(part: NDArray[np.uint8], t_us: NDArray[np.int64]) -> Values:
    """(PARTS, moduli) events at times divisible by each."""
    columns = []
    for multiple, moduli in MODULI:
        residues = tally(part, t_us % multiple, multiple)
        columns += [residues[:, ::m].sum(axis=1) for m in moduli]
    return np.stack(columns, axis=1)


@kernel
def runs(key: Any) -> Any:
    """(n,) how many in succession have the same key as this one."""
    size = np.empty(key.size, np.int64)
    first = 0
    for i in range(1, key.size + 1):
        if i == key.size or key[i] != key[first]:
            size[first:i] = i - first
            first = i
    return size


@kernel
def since(t_us: Any, lane: Any, lanes: Any) -> Any:
    """(n,) time since the last stamp of an event's lane that is not its own; long for the first."""
    now, before = np.full(lanes, -1 << 60, np.int64), np.full(lanes, -1 << 60, np.int64)
    gap = np.empty(t_us.size, np.int64)
    for i in range(t_us.size):
        k = lane[i]
        if t_us[i] != now[k]:
            before[k], now[k] = now[k], t_us[i]
        gap[i] = now[k] - before[k]
    return gap


READOUT = Group("D", _LABELS, observe_readout)
