"""Sudden changes of voltage within a step: from a band's list to the arrays that kernels take."""

from typing import Any

import numpy as np

from .effect import Band, Plane
from .groups import Kicks
from .kernel import kernel


def no_kicks(zeros: Plane) -> Kicks:
    """Those of a band without any, zeros (n,) its slack."""
    return Kicks(np.empty((0, 1)), np.empty((0, 1)), zeros)


def kicks_of(band: Band) -> Kicks:
    """A band's kicks, one or more, each row in order of time.

    A kick that a row does not have in this step stands at its end, at inf, with size 0. A row's slack is the
    largest sum of its kicks up to or from a time, more than 0 where there is any kick.
    """
    kicks = kicks_of_rows(band)
    return kicks._replace(slack=np.repeat(kicks.slack, band.sensor.width))


def kicks_of_rows(band: Band) -> Kicks:
    """The same with the slack of each row, (rows,), instead of each pixel."""
    band.kicks.sort(key=lambda kick: kick[0][0])  # of the first row: what is nearly in order is quick to sort
    times_us = np.stack([times_us for times_us, _ in band.kicks])
    sizes, slack = np.empty_like(times_us), np.empty(times_us.shape[1], np.float32)
    _in_order(
        np.array([size for _, size in band.kicks], np.float64), band.span_us, Kicks(times_us, sizes, slack)
    )
    return Kicks(times_us, sizes, slack)


@kernel
def _in_order(size: Any, span: Any, kicks: Any) -> None:
    """Sort the times of `Kicks` and fill its sizes, beside them, and slack (rows,); size: (kicks,)."""
    times, sizes = kicks.times_us, kicks.sizes
    count, rows = times.shape
    for row in range(rows):
        total = 0.0
        for k in range(count):
            at, of = times[k, row], size[k]
            if not (0 < at <= span):
                at, of = np.inf, 0.0
            total += of
            place = k
            while place > 0 and times[place - 1, row] > at:
                times[place, row], sizes[place, row] = times[place - 1, row], sizes[place - 1, row]
                place -= 1
            times[place, row], sizes[place, row] = at, of
        before = furthest = 0.0
        for k in range(count):
            before += sizes[k, row]
            furthest = max(furthest, abs(before), abs(total - before))
        kicks.slack[row] = furthest
