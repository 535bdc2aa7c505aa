"""The pixels near a barrier over one step: their paths drawn in blocks."""

import math
from typing import Any

import numpy as np

from .crossing_rounds import draw_crossings
from .event_key import event_address
from .first_passage import stays_inside
from .kernel import kernel
from .random import normals, sequences
from .single_path import DEEPEST, walk

BLOCK = 2048
"""Pixels that are drawn together: their numbers stay in the second cache."""


@kernel
def cross(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, held: Any,
    slack: Any, careful: Any, near: Any, first: Any, count: Any, key: Any, pixel0: Any, width: Any,
    period: Any, reset_sigma: Any, kick_times: Any, kick_sizes: Any, offset: Any, keys: Any,
) -> Any:  # fmt: skip
    """Draw the paths of the pixels near[first:count] and pack their events into keys.

    key: `interval_key` of the step; pixel0: number of the band's first pixel; period [us]: dead time after an
    event; reset_sigma: spread of the voltage after a reset. kick_times [us] and kick_sizes, (kicks, rows),
    each row in order of time: sudden changes of voltage, which drift includes; slack (pixels,): more than 0
    where there are some; careful: False when no pixel is held or kicked. offset [us]: start of the step in
    its interval.
    Returns (pixels done, events written). Stops before a block of pixels whose events do not fit into keys
    (capacity,) uint64; call again with more room, the same numbers are drawn.

    Pixels go in blocks: what all of them need, and the usual crossings of one barrier, are loops that the
    compiler vectorises (`draw_ends`, `find_touching`, `next_crossings`); the rest is followed one by one.
    """
    written = 0
    states, touching = np.empty(BLOCK, np.uint64), np.empty(BLOCK + 1, np.int32)
    start, end, a, b, noise2 = (
        np.empty(BLOCK),
        np.empty(BLOCK),
        np.empty(BLOCK),
        np.empty(BLOCK),
        np.empty(BLOCK),
    )
    wait, free, scratch = np.zeros(BLOCK), np.zeros(BLOCK), np.empty((12, BLOCK))
    cuts = np.empty((2, DEEPEST + 1))
    for begin in range(first, count, BLOCK):
        pixels = near[begin : min(begin + BLOCK, count)]
        n, done = pixels.shape[0], written
        sequences(key, pixel0, pixels, states)
        normals(states[:n], start[:n], end[:n])
        if careful:
            find_waits(held, span, pixels, wait, free, end)
        draw_ends(voltage, pending, drift, noise, span, above, below, pixels, wait, start, end, a, b, noise2)
        touches = find_touching(start[:n], end, a, b, noise2, wait, span, touching)
        if len(kick_sizes) > 0:
            touches = leave_out_kicked(touches, slack, pixels, touching)
            done = walk_kicked(
                slack, pixels, states, start, end, drift, span, a, b, noise2, free, period, reset_sigma,
                kick_times, kick_sizes, pixel0, width, offset, cuts, keys, done,
            )  # fmt: skip
        if done >= 0:
            done = draw_crossings(
                touching[:touches], pixels, states, start, end, a, b, noise2, wait, free, span, period,
                reset_sigma, pixel0, width, offset, scratch, cuts, keys, done,
            )  # fmt: skip
        if done < 0:
            return begin, written
        for k in range(n):
            voltage[pixels[k]] = end[k]
            pending[pixels[k]] = 0.0
        if careful:
            for k in range(n):
                held[pixels[k]] = max(free[k] - span, 0.0)
        written = done
    return count, written


@kernel
def find_waits(held: Any, span: Any, pixels: Any, wait: Any, free: Any, end: Any) -> None:
    """What of the step each pixel spends in its dead time; end, a normal number, is less by that.

    free: when the dead time ends.
    """
    for k in range(pixels.shape[0]):
        free[k] = held[pixels[k]]
        wait[k] = min(free[k], span)
        end[k] *= math.sqrt(1.0 - wait[k] / span)


@kernel
def draw_ends(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, pixels: Any,
    wait: Any, start: Any, end: Any, a: Any, b: Any, noise2: Any,
) -> None:  # fmt: skip
    """start, end: standard normal numbers to the voltages at the two ends of each path, before resets.

    A path starts after wait. a, b, noise2: filled with the distances of the barriers from 0 and sigma^2. All
    (n,) float64.
    """
    root, per_span = math.sqrt(span), 1.0 / span
    for k in range(pixels.shape[0]):
        i = pixels[k]
        sigma = np.float64(noise[i])
        a[k], b[k], noise2[k] = above[i], below[i], sigma * sigma
        x = np.float64(voltage[i]) + math.sqrt(np.float64(pending[i])) * start[k]
        x = min(max(x, -b[k]), a[k])  # beyond by rounding, by a kick, or where a threshold was lowered
        start[k] = x
        end[k] = x + np.float64(drift[i]) * ((span - wait[k]) * per_span) + sigma * root * end[k]


@kernel
def find_touching(
    start: Any, end: Any, a: Any, b: Any, noise2: Any, wait: Any, span: Any, touching: Any
) -> Any:  # fmt: skip
    """Fill touching with the places of the paths that may touch a barrier; returns their number."""
    inside = np.empty(start.shape[0], np.bool_)
    for k in range(start.shape[0]):
        inside[k] = stays_inside(start[k], end[k], a[k], b[k], noise2[k] * (span - wait[k]))
    count = 0
    for k in range(start.shape[0]):
        touching[count] = k
        count += not inside[k]
    return count


@kernel
def leave_out_kicked(count: Any, slack: Any, pixels: Any, touching: Any) -> Any:
    """Take pixels with kicks out of the first `count` of touching; returns how many are left."""
    left = 0
    for c in range(count):
        touching[left] = touching[c]
        left += slack[pixels[touching[c]]] <= 0.0
    return left


@kernel
def walk_kicked(
    slack: Any, pixels: Any, states: Any, start: Any, end: Any, drift: Any, span: Any, a: Any, b: Any,
    noise2: Any, free: Any, period: Any, reset_sigma: Any, kick_times: Any, kick_sizes: Any, pixel0: Any,
    width: Any, offset: Any, cuts: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """The paths and events of a block's pixels with kicks, to end and free. Returns `written`, as `walk`."""
    for k in range(pixels.shape[0]):
        i = pixels[k]
        if slack[i] > 0.0 and written >= 0:
            row, address = i // width, event_address(pixel0 + i, width, 1.0 / width)
            written, end[k], free[k] = walk(
                states[k], start[k], np.float64(drift[i]), free[k], span, noise2[k], a[k], b[k], period,
                reset_sigma, kick_times[:, row], kick_sizes[:, row], address, offset, cuts, keys, written,
            )  # fmt: skip
    return written
