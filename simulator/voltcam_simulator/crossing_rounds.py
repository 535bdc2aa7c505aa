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
    touching: Any, block: Any, step: Any, reset: Any, space: Any, keys: Any, written: Any
) -> Any:
    """The events of those of a block's `Paths` that touching names; fills their end and free_us.

    space: a `Space`. Returns `written`, -1 when keys is full.
    """
    n, scratch, cuts, again = touching.shape[0], space.scratch, space.cuts, space.again
    numbers, until, end, free = block.numbers, block.end_us, block.end, block.free_us
    paths = all_unfinished(scratch)
    begin_unfinished(touching, block, some_unfinished(paths, n))
    for turn in range(ROUNDS):
        if written + n > keys.shape[0]:
            return -1
        now = some_unfinished(paths, n)
        next_crossings(now, reset, scratch[9:])
        written = write_keys(touching[:n], block, now, step, keys, written)
        for c in range(n):
            k = touching[c]
            end[k], free[k] = now.y[c], max(until[k] - now.left[c], free[k])  # not before that from before
        rest = find_unfinished(now, space.marks, again)
        n = 0
        for place in range(rest):
            c = again[place]
            k = touching[c]
            if now.side[c] == 0.0 or turn == ROUNDS - 1:
                address = event_address(step.first_pixel + numbers[k], step.width, 1.0 / step.width)
                pixel = Pixel(now.noise2[c], now.above[c], now.below[c], address, step.offset_us)
                written, end[k], free[k] = follow(
                    now.states[c], now.x[c], now.y[c], until[k] - now.left[c], until[k], pixel, reset, cuts,
                    keys, written,
                )[1:]  # fmt: skip
                if written < 0:
                    return -1
            else:
                move(paths, c, n)
                touching[n] = k
                n += 1
    return written


@kernel
def all_unfinished(scratch: Any) -> Any:
    """Space for a block in the first nine rows."""
    return Unfinished(
        scratch[0].view(np.uint64), scratch[1], scratch[2], scratch[3], scratch[4], scratch[5], scratch[6],
        scratch[7], scratch[8],
    )  # fmt: skip


@kernel
def some_unfinished(paths: Any, count: Any) -> Any:
    """The first so many of them."""
    return Unfinished(
        paths.states[:count], paths.x[:count], paths.y[:count], paths.above[:count], paths.below[:count],
        paths.noise2[:count], paths.left[:count], paths.side[:count], paths.time[:count],
    )  # fmt: skip


@kernel
def begin_unfinished(touching: Any, block: Any, paths: Any) -> None:
    """Those of a block that touching names, at their start."""
    for c in range(touching.shape[0]):
        k = touching[c]
        paths.states[c], paths.x[c], paths.y[c] = block.states[k], block.start[k], block.end[k]
        paths.above[c], paths.below[c] = block.above[k], block.below[k]
        paths.noise2[c], paths.left[c] = block.noise2[k], block.left_us[k]


@kernel
def move(paths: Any, c: Any, n: Any) -> None:
    """A path from place c to place n."""
    paths.states[n], paths.x[n], paths.y[n] = paths.states[c], paths.x[c], paths.y[c]
    paths.above[n], paths.below[n] = paths.above[c], paths.below[c]
    paths.noise2[n], paths.left[n] = paths.noise2[c], paths.left[c]


@kernel
def write_keys(touching: Any, block: Any, paths: Any, step: Any, keys: Any, written: Any) -> Any:
    """The events just drawn, into keys[written:], which has room for one of each path. Returns `written`."""
    numbers, until, side, time = block.numbers, block.end_us, paths.side, paths.time
    per_width = 1.0 / step.width
    for c in range(touching.shape[0]):
        k = touching[c]
        address = event_address(step.first_pixel + numbers[k], step.width, per_width)
        keys[written] = event_key(step.offset_us + (until[k] - time[c]), address, side[c])
        written += side[c] != 0.0
    return written


@kernel
def find_unfinished(paths: Any, inside: Any, places: Any) -> Any:
    """Fill places with those of the paths that may touch a threshold in their time; returns their number.

    inside (n or more,) bool: is worked on.
    """
    n, x, y, above, below = paths.states.shape[0], paths.x, paths.y, paths.above, paths.below
    noise2, left = paths.noise2, paths.left
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
    path of another kind stays as it is, its side is 0. scratch (3, m or more). Each loop fills one column,
    as in `paths.draw_ends`.
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
        reach = (x[c] + below[c]) * (y[c] + below[c]) if on else (above[c] - x[c]) * (above[c] - y[c])
        sure = (beyond >= 0.0) & (near > 0.0) & (reach >= -0.5 * LOG_MISS * noise2[c] * left[c])
        side[c] = (1.0 if on else -1.0) if sure else 0.0
    for c in range(n):
        near = above[c] - x[c] if side[c] > 0.0 else x[c] + below[c]
        x[c] = near if side[c] != 0.0 else x[c]
    for c in range(n):
        beyond = y[c] - above[c] if side[c] > 0.0 else y[c] + below[c]
        y[c] = beyond if side[c] != 0.0 else y[c]
    for c in range(n):
        share = touching_share(x[c], abs(y[c]), noise2[c] * left[c], gauss[c], u[c])
        time[c] = left[c] - left[c] * share if side[c] != 0.0 else left[c]
    for c in range(n):
        x[c] = 0.0 if side[c] != 0.0 else x[c]
        left[c] = time[c]
    dead_us = reset.dead_us
    if dead_us > 0.0:
        for c in range(n):  # what the path does in the dead time is lost
            share = min(dead_us / left[c], 1.0) if left[c] > 0.0 else 1.0
            slept = share * y[c] + math.sqrt(noise2[c] * max(left[c], 0.0) * share * (1.0 - share)) * other[c]
            y[c] -= slept if side[c] != 0.0 else 0.0
        for c in range(n):
            left[c] -= dead_us if side[c] != 0.0 else 0.0
    if reset.sigma > 0.0:
        normals(paths.states, gauss, other)
        for c in range(n):
            level = min(max(reset.sigma * gauss[c], -0.9 * below[c]), 0.9 * above[c])
            gauss[c] = level if side[c] != 0.0 else 0.0
        for c in range(n):
            x[c] += gauss[c]
            y[c] += gauss[c]
