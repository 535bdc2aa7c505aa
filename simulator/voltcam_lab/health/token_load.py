"""With which load a token begins its rounds, and what ends them: from stamps and rows, by the millisecond.

The load is what `arbiter_scan` takes it for: the mean of the last four milliseconds, all of them after the
last burst; and a mean over some 0.3 ms for bursts.
"""

from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from voltcam_simulator.effect import Events
from voltcam_simulator.effects.arbiter_scan import BURST_US, OFTEN, SLOT_US, SLOTS
from voltcam_simulator.kernel import kernel

Flags = NDArray[np.bool_]
USUAL_STEEPNESS, STEEPNESS_SD = 7.0, 2.0
"""Power of the load, and its sd, before anything was seen: rounds begin so seldom that a recording tells
little. Measured on all of slider_depth: 31 began, 5 to 9 is within two units of log likelihood."""
UNSEEN = 0.5  # begins, where a recording has none: as Jeffreys' prior has it
STEPS = 30  # of Newton's method
MOST_TOGETHER = 16
NO_BURST = 1000.0  # events/us: more than any sensor gives
CLEARLY = 1.3  # times the load of all other times: what ends the rounds is a burst


def begins_with_load(counts: NDArray[np.int64], going: Flags, bursts: Flags) -> tuple[float, float]:
    """(busy_per_us, steepness) with which rounds begin; counts (slots,): events of each millisecond; going:
    whether the token went round in it; bursts: whether there was one.

    Most likely for OFTEN (load / busy_per_us) ^ steepness a slot, in slots that do not follow one with rounds
    or, within SLOTS, a burst. (0, 0), always, where there are none; where none begins, half a one is taken.
    """
    load = sliding_window_view(counts, SLOTS).mean(axis=-1)[:-1] / SLOT_US  # of the slots before each
    burst = sliding_window_view(bursts, SLOTS).max(axis=-1)[:-1]
    free = (load > 0) & ~going[SLOTS - 1 : -1] & ~burst
    begins, log_load = going[SLOTS:][free], np.log(load[free])
    if not free.any():
        return 0.0, 0.0
    if not begins.any():
        often = UNSEEN / begins.size
        return float(np.exp(log_load.mean()) * (OFTEN / often) ** (1 / USUAL_STEEPNESS)), USUAL_STEEPNESS
    middle = log_load[begins].mean()
    power = log_load - middle
    level, steepness = float(np.log(begins.mean())), USUAL_STEEPNESS
    for _ in range(STEPS):
        expected = np.exp(np.clip(level + steepness * power, None, 0))
        error = begins - expected
        pull = (USUAL_STEEPNESS - steepness) / STEEPNESS_SD**2
        slope = np.array([error.sum(), (error * power).sum() + pull])
        mixed = (expected * power).sum()
        bend = np.array([[expected.sum(), mixed], [mixed, (expected * power**2).sum() + STEEPNESS_SD**-2]])
        step = np.linalg.solve(bend, slope)
        level, steepness = level + step[0], max(steepness + step[1], 1.0)
    return float(np.exp(middle + (np.log(OFTEN) - level) / steepness)), float(steepness)


def burst_that_ends(
    t_us: NDArray[np.int64], loads: NDArray[np.float64], stretches: NDArray[np.int64]
) -> float:
    """The load [1/us], over some 0.3 ms, between what rounds go on with and what they end with; NO_BURST if
    they end with nothing of the kind. loads: `burst_loads`; stretches (n, 2): from when to when the token
    goes round [us]."""

    def most(begin_us: int, end_us: int) -> float:
        first, last = np.searchsorted(t_us, [begin_us, end_us])
        return float(loads[first:last].max(initial=0.0))

    ends = [most(end - SLOT_US, end + SLOT_US) for _, end in stretches.tolist()]
    inside = max(most(begin + SLOT_US, end - 2 * SLOT_US) for begin, end in stretches.tolist())
    usual = float(np.median(ends))
    if inside == 0 or usual < CLEARLY * inside:
        return NO_BURST
    return float(np.sqrt(max(float(np.quantile(ends, 0.1)), inside) * inside))


def rows_together(events: Events, stretches: NDArray[np.int64], round_us: float) -> int:
    """How many rows the token passes at once: with so many, as many events would share the stamp of another
    row's as do."""
    parts = [events[slice(*np.searchsorted(events["t"], [begin, end]))] for begin, end in stretches.tolist()]
    shared = sum(
        np.count_nonzero((np.diff(part["t"]) == 0) & (np.diff(part["y"].astype(np.int64)) != 0))
        for part in parts
    )
    expected = [
        sum(_further_rows(part, together, round_us) for part in parts)
        for together in range(1, MOST_TOGETHER + 1)
    ]
    return 1 + int(np.argmin(np.abs(np.array(expected) - shared)))


def _further_rows(part: Events, together: int, round_us: float) -> int:
    """Rows that leave behind another one that the token passes at the same time."""
    t_us, row = part["t"].astype(np.int64), part["y"].astype(np.int64)
    order = np.lexsort((t_us, row // together))
    t_us, row = t_us[order], row[order]
    block = row // together
    visit = np.cumsum(np.diff(block, prepend=-1).astype(bool) | (np.diff(t_us, prepend=0) > round_us / 2))
    rows = np.unique(visit * together + row % together).size
    return rows - np.unique(visit).size


@kernel
def burst_loads(t_us: Any) -> Any:
    """(events,) events/us up to each of them, an exponential mean over BURST_US."""
    loads, load = np.empty(t_us.shape[0]), 0.0
    for i in range(t_us.shape[0]):
        if i > 0:
            load *= np.exp(-(t_us[i] - t_us[i - 1]) / BURST_US)
        load += 1 / BURST_US
        loads[i] = load
    return loads
