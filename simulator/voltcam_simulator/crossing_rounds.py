"""The events of a block of pixels: the next one of all of them at once, and again for those that go on."""

import math
from typing import Any

import numpy as np

from .event_key import event_address, event_key
from .first_passage import LOG_MISS, stays_inside, touching_share
from .kernel import kernel
from .random import normals, uniforms
from .single_path import follow

TURNS = 4
"""Events of a pixel that are drawn together with those of others; later ones are followed."""


@kernel
def draw_crossings(
    touching: Any, pixels: Any, states: Any, start: Any, end: Any, a: Any, b: Any, noise2: Any, wait: Any,
    free: Any, span: Any, period: Any, reset_sigma: Any, pixel0: Any, width: Any, offset: Any, scratch: Any,
    cuts: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """The events of the paths at the places touching: their ends and when they are free go to end and free.

    Returns `written`, -1 when keys is full. scratch (12, BLOCK): what is worked on side by side.
    """
    n, per_width = touching.shape[0], 1.0 / width
    own, again = scratch[0, :n].view(np.uint64), np.empty(n + 1, np.int32)
    x, y, above, below = scratch[1], scratch[2], scratch[3], scratch[4]
    sigma2, left, side, time = scratch[5], scratch[6], scratch[7], scratch[8]
    for c in range(n):
        k = touching[c]
        own[c], x[c], y[c], above[c], below[c] = states[k], start[k], end[k], a[k], b[k]
        sigma2[c], left[c] = noise2[k], span - wait[k]
    for turn in range(TURNS):
        if written + n > keys.shape[0]:
            return -1
        next_crossings(
            own[:n], x, y, above, below, sigma2, left, side, time, period, reset_sigma, scratch[9:]
        )
        for c in range(n):
            k = touching[c]
            address = event_address(pixel0 + pixels[k], width, per_width)
            keys[written] = event_key(offset + (span - time[c]), address, side[c])
            written += side[c] != 0.0
            end[k], free[k] = y[c], max(span - left[c], free[k])  # not less than a dead time from before
        rest = find_unfinished(x[:n], y, above, below, sigma2, left, again)
        n = 0
        for c in again[:rest]:
            k = touching[c]
            if side[c] == 0.0 or turn == TURNS - 1:
                address = event_address(pixel0 + pixels[k], width, per_width)
                written, end[k], free[k] = follow(
                    own[c], x[c], y[c], span - left[c], span, sigma2[c], above[c], below[c], period,
                    reset_sigma, address, offset, cuts, keys, written,
                )[1:]  # fmt: skip
                if written < 0:
                    return -1
            else:
                own[n], x[n], y[n], above[n], below[n] = own[c], x[c], y[c], above[c], below[c]
                sigma2[n], left[n], touching[n] = sigma2[c], left[c], k
                n += 1
    return written


@kernel
def find_unfinished(
    x: Any, y: Any, above: Any, below: Any, noise2: Any, left: Any, places: Any
) -> Any:  # fmt: skip
    """Fill places with those of the paths that may touch a barrier in the time left; returns their number."""
    inside = np.empty(x.shape[0], np.bool_)
    for c in range(x.shape[0]):
        inside[c] = (left[c] <= 0.0) | stays_inside(x[c], y[c], above[c], below[c], noise2[c] * left[c])
    count = 0
    for c in range(x.shape[0]):
        places[count] = c
        count += not inside[c]
    return count


@kernel
def next_crossings(
    states: Any, x: Any, y: Any, above: Any, below: Any, noise2: Any, left: Any, side: Any, time: Any,
    period: Any, reset_sigma: Any, scratch: Any,
) -> None:  # fmt: skip
    """The next event of the paths that surely cross one barrier and cannot reach the other.

    A path goes from x to y in the time left; both become those after the event, its reset and dead time (left
    may be less than 0 then). Fills side (+1 ON, -1 OFF, 0: not such a path, all stays) and time, what is left
    of the step at the event [us]. scratch (3, n or more).
    """
    n = states.shape[0]
    gauss, other, u = scratch[0, :n], scratch[1, :n], scratch[2, :n]
    normals(states, gauss, other)
    uniforms(states, u)
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
    if period > 0.0:
        for c in range(n):  # what the path does in the dead time is lost
            share = min(period / left[c], 1.0) if left[c] > 0.0 else 1.0
            slept = share * y[c] + math.sqrt(noise2[c] * max(left[c], 0.0) * share * (1.0 - share)) * other[c]
            y[c] -= slept if side[c] != 0.0 else 0.0
            left[c] -= period if side[c] != 0.0 else 0.0
    if reset_sigma > 0.0:
        normals(states, gauss, other)
        for c in range(n):
            level = min(max(reset_sigma * gauss[c], -0.9 * below[c]), 0.9 * above[c])
            x[c] += level if side[c] != 0.0 else 0.0
            y[c] += level if side[c] != 0.0 else 0.0
