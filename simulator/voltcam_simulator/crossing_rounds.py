"""The events of a block of pixels, in rounds: the next one of all at once, and again for those that go on."""

import math
from typing import Any, NamedTuple

import numpy as np

from .event_key import event_address, event_key
from .first_passage import LOG_MISS, stays_inside, touching_share
from .kernel import kernel
from .random import normals, uniforms
from .single_path import Pixel, follow

ROUNDS = 4
"""Events of a pixel that are drawn together with those of others; later ones are followed."""


class Unfinished(NamedTuple):
    """Paths on their way to their next event, side by side; (m,) float64, in nominal thresholds and us."""

    states: Any
    """uint64: their sequences of random numbers."""
    x: Any
    """Where a path is."""
    y: Any
    """Where it is at the end of the step, if there are no more resets."""
    above: Any
    """The ON threshold."""
    below: Any
    """The OFF threshold, as a distance from 0."""
    noise2: Any
    """sigma^2 [1/us]."""
    left: Any
    """Time left in the step; less than 0 where a dead time goes beyond it."""
    side: Any
    """Of the event just drawn: +1 ON, -1 OFF, 0: none, since the path may reach either threshold."""
    time: Any
    """What was left of the step at that event."""


@kernel
def draw_crossings(
    touching: Any, block: Any, step: Any, reset: Any, scratch: Any, cuts: Any, keys: Any, written: Any
) -> Any:
    """The events of a block's `Paths` at the places touching; fills their end and free_us.

    scratch (12, BLOCK): what is worked on side by side. Returns `written`, -1 when keys is full.
    """
    n, per_width, span = touching.shape[0], 1.0 / step.width, step.span_us
    pixels, end, free = block.pixels, block.end, block.free_us
    own, again = scratch[0, :n].view(np.uint64), np.empty(n + 1, np.int32)
    x, y, above, below = scratch[1], scratch[2], scratch[3], scratch[4]
    noise2, left, side, time = scratch[5], scratch[6], scratch[7], scratch[8]
    for c in range(n):
        k = touching[c]
        own[c], x[c], y[c], above[c] = block.states[k], block.start[k], end[k], block.above[k]
        below[c], noise2[c], left[c] = block.below[k], block.noise2[k], span - block.wait_us[k]
    for turn in range(ROUNDS):
        if written + n > keys.shape[0]:
            return -1
        paths = Unfinished(own[:n], x, y, above, below, noise2, left, side, time)
        next_crossings(paths, reset, scratch[9:])
        for c in range(n):
            k = touching[c]
            address = event_address(step.first_pixel + pixels[k], step.width, per_width)
            keys[written] = event_key(step.offset_us + (span - time[c]), address, side[c])
            written += side[c] != 0.0
            end[k], free[k] = y[c], max(span - left[c], free[k])  # not less than a dead time from before
        rest = find_unfinished(paths, again)
        n = 0
        for c in again[:rest]:
            k = touching[c]
            if side[c] == 0.0 or turn == ROUNDS - 1:
                address = event_address(step.first_pixel + pixels[k], step.width, per_width)
                pixel = Pixel(noise2[c], above[c], below[c], address, step.offset_us)
                written, end[k], free[k] = follow(
                    own[c], x[c], y[c], span - left[c], span, pixel, reset, cuts, keys, written
                )[1:]
                if written < 0:
                    return -1
            else:
                own[n], x[n], y[n], above[n], below[n] = own[c], x[c], y[c], above[c], below[c]
                noise2[n], left[n], touching[n] = noise2[c], left[c], k
                n += 1
    return written


@kernel
def find_unfinished(paths: Any, places: Any) -> Any:
    """Fill places with those of the paths that may touch a threshold in their time; returns their number."""
    n, x, y, above, below = paths.states.shape[0], paths.x, paths.y, paths.above, paths.below
    noise2, left = paths.noise2, paths.left
    inside = np.empty(n, np.bool_)
    for c in range(n):
        inside[c] = (left[c] <= 0.0) | stays_inside(x[c], y[c], above[c], below[c], noise2[c] * left[c])
    count = 0
    for c in range(n):
        places[count] = c
        count += not inside[c]
    return count


@kernel
def next_crossings(paths: Any, reset: Any, scratch: Any) -> None:
    """The next event of the paths that surely cross one threshold and cannot reach the other.

    Their x, y and left become those after the event, its reset and dead time; side and time are filled. A
    path of another kind stays as it is, its side is 0. scratch (3, m or more).
    """
    n, x, y, above, below = paths.states.shape[0], paths.x, paths.y, paths.above, paths.below
    noise2, left, side, time = paths.noise2, paths.left, paths.side, paths.time
    gauss, other, u = scratch[0, :n], scratch[1, :n], scratch[2, :n]
    normals(paths.states, gauss, other)
    uniforms(paths.states, u)
    for c in range(n):
        on = y[c] >= above[c]
        near = above[c] - x[c] if on else x[c] + below[c]
        beyond = y[c] - above[c] if on else -below[c] - y[c]
        variance = noise2[c] * left[c]
        reach = (x[c] + below[c]) * (y[c] + below[c]) if on else (above[c] - x[c]) * (above[c] - y[c])
        sure = (beyond >= 0.0) & (near > 0.0) & (reach >= -0.5 * LOG_MISS * variance)
        share = touching_share(near, beyond, variance, gauss[c], u[c])
        side[c] = (1.0 if on else -1.0) if sure else 0.0
        time[c] = left[c] - left[c] * share if sure else left[c]
        x[c] = 0.0 if sure else x[c]
        y[c] = (beyond if on else -beyond) if sure else y[c]
        left[c] = time[c]
    dead_us = reset.dead_us
    if dead_us > 0.0:
        for c in range(n):  # what the path does in the dead time is lost
            share = min(dead_us / left[c], 1.0) if left[c] > 0.0 else 1.0
            slept = share * y[c] + math.sqrt(noise2[c] * max(left[c], 0.0) * share * (1.0 - share)) * other[c]
            y[c] -= slept if side[c] != 0.0 else 0.0
            left[c] -= dead_us if side[c] != 0.0 else 0.0
    if reset.sigma > 0.0:
        normals(paths.states, gauss, other)
        for c in range(n):
            level = min(max(reset.sigma * gauss[c], -0.9 * below[c]), 0.9 * above[c])
            x[c] += level if side[c] != 0.0 else 0.0
            y[c] += level if side[c] != 0.0 else 0.0
