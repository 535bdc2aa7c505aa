"""The pixels near a barrier over one step: their paths drawn in blocks, and their events."""

import math
from typing import Any

import numpy as np

from .event_key import event_address, event_key
from .first_passage import LOG_MISS, stays_inside, touching_share
from .kernel import kernel
from .path import DEEPEST, follow, walk
from .random import normals, sequences, uniforms

BLOCK = 512
"""Pixels that are drawn together: their numbers stay in the first cache."""


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

    Pixels go in blocks: what all of them need, and the usual single crossing, are loops that the compiler
    vectorises (`draw_ends`, `find_touching`, `first_crossings`); the rest is followed one by one.
    """
    written, per_width = 0, 1.0 / width
    states, touching = np.empty(BLOCK, np.uint64), np.empty(BLOCK + 1, np.int32)
    start, end, a, b = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    variance, wait, side, time = np.empty(BLOCK), np.zeros(BLOCK), np.empty(BLOCK, np.int8), np.empty(BLOCK)
    x, y, free = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    cuts = np.empty((2, DEEPEST + 1))
    for begin in range(first, count, BLOCK):
        pixels = near[begin : min(begin + BLOCK, count)]
        n, done = pixels.shape[0], written
        if done + n > keys.shape[0]:
            return begin, written
        sequences(key, pixel0, pixels, states)
        normals(states[:n], start[:n], end[:n])
        if careful:
            find_waits(held, span, pixels, wait, end)
        draw_ends(
            voltage, pending, drift, noise, span, above, below, pixels, wait, start, end, a, b, variance
        )
        touches = find_touching(start[:n], end, a, b, variance, touching)
        if careful:
            touches = add_kicked(touches, slack, pixels, touching)
        first_crossings(
            touching[:touches], states, start, end, a, b, variance, span, wait, period, reset_sigma,
            side, time, x, y, free,
        )  # fmt: skip
        for c in range(touches):
            k = touching[c]
            i = pixels[k]
            noise2 = np.float64(noise[i]) * np.float64(noise[i])
            address = event_address(pixel0 + i, width, per_width)
            if careful and slack[i] > 0.0:
                row = i // width
                done, y[c], free[c] = walk(
                    states[k], start[k], np.float64(drift[i]), np.float64(held[i]), span, noise2,
                    a[k], b[k], period, reset_sigma, kick_times[:, row], kick_sizes[:, row],
                    address, offset, cuts, keys, done,
                )  # fmt: skip
            else:
                if side[c] != 0:
                    keys[done] = event_key(offset + time[c], address, side[c])
                    done += 1
                left = span - free[c]
                if left > 0.0 and not stays_inside(x[c], y[c], a[k], b[k], noise2 * left):
                    done, y[c], free[c] = follow(
                        states[k], x[c], y[c], free[c], span, noise2, a[k], b[k], period, reset_sigma,
                        address, offset, cuts, keys, done,
                    )[1:]  # fmt: skip
            if done < 0 or done + n > keys.shape[0]:
                return begin, written
            end[k] = y[c]
        for k in range(n):
            voltage[pixels[k]] = end[k]
            pending[pixels[k]] = 0.0
        if careful:
            for k in range(n):
                held[pixels[k]] = max(held[pixels[k]] - span, 0.0)
            for c in range(touches):
                held[pixels[touching[c]]] = max(free[c] - span, 0.0)
        written = done
    return count, written


@kernel
def find_waits(held: Any, span: Any, pixels: Any, wait: Any, end: Any) -> None:
    """What of the step each pixel spends in its dead time; end, a normal number, is less by that."""
    for k in range(pixels.shape[0]):
        wait[k] = min(np.float64(held[pixels[k]]), span)
        end[k] *= math.sqrt(1.0 - wait[k] / span)


@kernel
def draw_ends(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, pixels: Any,
    wait: Any, start: Any, end: Any, a: Any, b: Any, variance: Any,
) -> None:  # fmt: skip
    """start, end: standard normal numbers to the voltages at the two ends of each path, before resets.

    A path starts after wait. a, b, variance: filled with the distances of the barriers from 0 and the path's
    variance. All (n,) float64.
    """
    root, per_span = math.sqrt(span), 1.0 / span
    for k in range(pixels.shape[0]):
        i = pixels[k]
        sigma = np.float64(noise[i])
        left = span - wait[k]
        a[k], b[k], variance[k] = above[i], below[i], sigma * sigma * left
        x = np.float64(voltage[i]) + math.sqrt(np.float64(pending[i])) * start[k]
        x = min(max(x, -b[k]), a[k])  # beyond by rounding, by a kick, or where a threshold was lowered
        start[k] = x
        end[k] = x + np.float64(drift[i]) * (left * per_span) + sigma * root * end[k]


@kernel
def find_touching(
    start: Any, end: Any, a: Any, b: Any, variance: Any, touching: Any
) -> Any:  # fmt: skip
    """Fill touching with the places of the paths that may touch a barrier; returns their number."""
    inside = np.empty(start.shape[0], np.bool_)
    for k in range(start.shape[0]):
        inside[k] = stays_inside(start[k], end[k], a[k], b[k], variance[k])
    count = 0
    for k in range(start.shape[0]):
        touching[count] = k
        count += not inside[k]
    return count


@kernel
def add_kicked(count: Any, slack: Any, pixels: Any, touching: Any) -> Any:
    """Add the places of pixels with kicks to the first `count` of touching; returns their number."""
    touches = np.zeros(pixels.shape[0], np.bool_)
    for c in range(count):
        touches[touching[c]] = True
    count = 0
    for k in range(pixels.shape[0]):
        touching[count] = k
        count += touches[k] | (slack[pixels[k]] > 0.0)
    return count


@kernel
def first_crossings(
    touching: Any, states: Any, start: Any, end: Any, a: Any, b: Any, variance: Any, span: Any, wait: Any,
    period: Any, reset_sigma: Any, side: Any, time: Any, x: Any, y: Any, free: Any,
) -> None:  # fmt: skip
    """The first event of the paths that surely cross one barrier and cannot reach the other.

    touching (n,): places of the paths. Fills side (+1 ON, -1 OFF, 0: not such a path), time [us], and where
    the path goes on: from voltage x at time free, after the dead time, to y at the end of the step.
    """
    n = touching.shape[0]
    own, gauss, other, u = np.empty(n, np.uint64), np.empty(n), np.empty(n), np.empty(n)
    distance, beyond, spread, left = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for c in range(n):
        k = touching[c]
        own[c] = states[k]
        above, below, begin, stop = a[k], b[k], start[k], end[k]
        on = stop >= above
        distance[c] = above - begin if on else begin + below
        beyond[c] = stop - above if on else -below - stop
        left[c] = span - wait[k]
        spread[c] = variance[k]
        reach = (begin + below) * (stop + below) if on else (above - begin) * (above - stop)
        sure = (beyond[c] >= 0.0) & (distance[c] > 0.0) & (reach >= -0.5 * LOG_MISS * spread[c])
        side[c] = (1 if on else -1) if sure else 0
        x[c] = 0.0 if sure else begin
        y[c] = (beyond[c] if on else -beyond[c]) if sure else stop
    normals(own, gauss, other)
    uniforms(own, u)
    for c in range(n):
        time[c] = left[c] * touching_share(distance[c], beyond[c], spread[c], gauss[c], u[c])
    for c in range(n):
        time[c] += span - left[c]
        free[c] = time[c] + period if side[c] != 0 else span - left[c]
    if period > 0.0:
        for c in range(n):
            spread[c] /= max(left[c], 1e-300)  # sigma^2
        sleep(time[:n], other, spread, span, period, side, y)
    if reset_sigma > 0.0:
        normals(own, gauss, other)
        for c in range(n):
            k = touching[c]
            level = min(max(reset_sigma * gauss[c], -0.9 * b[k]), 0.9 * a[k]) if side[c] != 0 else 0.0
            x[c] += level
            y[c] += level
    for c in range(n):
        states[touching[c]] = own[c]


@kernel
def sleep(time: Any, gauss: Any, noise2: Any, span: Any, period: Any, side: Any, y: Any) -> None:
    """Take what paths do in the dead time after their first event off their ends."""
    for c in range(time.shape[0]):
        left = span - time[c]
        share = min(period / left, 1.0) if left > 0.0 else 1.0
        slept = share * y[c] + math.sqrt(noise2[c] * left * share * (1.0 - share)) * gauss[c]
        y[c] -= slept if side[c] != 0 else 0.0
