"""The path of one pixel, followed event by event, by the laws of `first_passage`."""

import math
from typing import Any, NamedTuple

from .event_key import event_key
from .first_passage import exit_of_bridge, needs_cut, stays_inside
from .kernel import kernel
from .random import normal

DEEPEST = 64
"""Halvings of an interval after which its two ends are the same number."""


class Pixel(NamedTuple):
    """One pixel over a step; scalars."""

    noise2: Any
    """sigma^2 [1/us]."""
    above: Any
    """The ON threshold."""
    below: Any
    """The OFF threshold, as a distance from 0."""
    address: Any
    """Its coordinates, as `event_address` packs them."""
    offset_us: Any
    """When the step starts in its interval."""


@kernel
def follow_kicked(
    state: Any, x: Any, drift: Any, now: Any, begin: Any, end: Any, pixel: Any, reset: Any, kick_times: Any,
    kick_sizes: Any, cuts: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """The path of one pixel from begin to end, of voltage x at first and free from `now` on, with its kicks.

    kick_times (kicks,) in order, kick_sizes: those within (begin, end] count, and are in the drift.
    Returns (written, voltage at the end, time from which the pixel is free), as `follow`.
    """
    first, last, kicked = 0, 0, 0.0
    for kick in range(kick_sizes.shape[0]):
        first += kick_times[kick] <= begin
        last += kick_times[kick] <= end
    for kick in range(first, last):
        kicked += kick_sizes[kick]
    slope = (drift - kicked) / (end - begin)
    for kick in range(first, last + 1):  # the path up to each kick, and to the end
        until = kick_times[kick] if kick < last else end
        if until > now:
            x = min(max(x, -pixel.below), pixel.above)
            state, gauss = normal(state)
            variance = pixel.noise2 * (until - now)
            y = x + slope * (until - now) + math.sqrt(variance) * gauss
            if stays_inside(x, y, pixel.above, pixel.below, variance):
                x, now = y, until
            else:
                state, written, x, now = follow(state, x, y, now, until, pixel, reset, cuts, keys, written)
                if written < 0:
                    return written, x, now
        if kick < last and now <= until:  # in its dead time a pixel memorises the kick
            x += kick_sizes[kick]
    return written, x, now


@kernel
def follow(
    state: Any, x: Any, y: Any, begin: Any, end: Any, pixel: Any, reset: Any, cuts: Any, keys: Any,
    written: Any,
) -> Any:  # fmt: skip
    """All events of one pixel from begin to end, its path going from x to y if there were no resets.

    pixel, reset: a `Pixel` and a `Reset`; times [us]; cuts (2, DEEPEST + 1): space for the ends of bridges
    that were cut.
    Fills keys[written:]. Returns (state, written, voltage at the end, time from which the pixel is free: end,
    or later by what is left of its dead time); written is -1 when keys is full.
    """
    above, below = pixel.above, pixel.below
    cuts[0, 0], cuts[1, 0] = end, y
    depth, now, fallen = 0, begin, 0.0  # fallen: what resets have subtracted from the path so far
    while depth >= 0:
        left = cuts[0, depth] - now
        stop = cuts[1, depth] - fallen
        variance = pixel.noise2 * left
        if depth < DEEPEST and needs_cut(x, stop, above, below, variance):
            state, gauss = normal(state)
            depth += 1
            cuts[0, depth] = now + 0.5 * left
            cuts[1, depth] = 0.5 * (x + stop) + 0.5 * math.sqrt(variance) * gauss + fallen
            continue
        state, side, time = exit_of_bridge(state, x, stop, left, variance, above, below)
        if side == 0:
            now, x = cuts[0, depth], stop
            depth -= 1
            continue
        if written == keys.shape[0]:
            return state, -1, 0.0, now
        now = min(now + time, cuts[0, depth])
        keys[written] = event_key(pixel.offset_us + now, pixel.address, side)
        written += 1
        path = fallen + (above if side > 0 else -below)  # where the path would be without resets
        if reset.dead_us > 0.0:
            state, depth, now, path = pass_dead_time(
                state, depth, now, path, reset.dead_us, pixel.noise2, cuts
            )
        x = 0.0
        if reset.sigma > 0.0:
            state, gauss = normal(state)
            x = min(max(reset.sigma * gauss, -0.9 * below), 0.9 * above)
        fallen = path - x
    return state, written, x, now


@kernel
def pass_dead_time(state: Any, depth: Any, now: Any, path: Any, dead_us: Any, noise2: Any, cuts: Any) -> Any:
    """Let the path go on through the dead time. Returns (state, depth, time, path) at its end."""
    resume = now + dead_us
    while depth >= 0 and cuts[0, depth] <= resume:
        now, path = cuts[0, depth], cuts[1, depth]
        depth -= 1
    if depth >= 0:
        left = cuts[0, depth] - now
        share = (resume - now) / left
        state, gauss = normal(state)
        path += share * (cuts[1, depth] - path) + math.sqrt(noise2 * left * share * (1.0 - share)) * gauss
    return state, depth, resume, path
