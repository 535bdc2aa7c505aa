"""The pixels near a threshold over one step: their paths drawn in blocks."""

import math
from typing import Any, NamedTuple

import numpy as np

from .crossing_rounds import draw_crossings
from .event_key import event_address
from .first_passage import stays_inside
from .groups import Kicks, Motion, Pixels, Reset, Step
from .kernel import kernel
from .random import normals, sequences
from .single_path import DEEPEST, Pixel, follow_kicked

BLOCK = 2048
"""Pixels that are drawn together: their numbers stay in the second cache."""


class Paths(NamedTuple):
    """The paths of a block of pixels over a step; (BLOCK,) float64, of which the first m are in use."""

    pixels: Any
    """(m,) int32: which pixels of the band."""
    states: Any
    """uint64: their sequences of random numbers."""
    start: Any
    """Voltage at the start of the path."""
    end: Any
    """Voltage at the end of the step, first without resets, in the end with them."""
    above: Any
    """The ON threshold."""
    below: Any
    """The OFF threshold, as a distance from 0."""
    noise2: Any
    """sigma^2 [1/us]."""
    wait_us: Any
    """What of the step a pixel spends in its dead time; its path starts then."""
    free_us: Any
    """When the dead time ends, from the start of the step: that before it, in the end that of its events."""


@kernel
def cross(
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, drift: Any, noise: Any,
    key: Any, span_us: Any, offset_us: Any, first_pixel: Any, width: Any, dead_us: Any, sigma: Any,
    kick_times_us: Any, kick_sizes: Any, slack: Any, careful: Any, near: Any, first: Any, count: Any,
    keys: Any,
) -> Any:  # fmt: skip
    """Draw the paths of the pixels near[first:count] and pack their events into keys.

    Called as cross(*pixels, *motion, *step, *reset, *kicks, careful, near, first, count, keys), see `groups`.
    careful: False when no pixel is held or kicked.
    Returns (pixels done, events written). Stops before a block of pixels whose events do not fit into keys
    (capacity,) uint64; call again with more room, the same numbers are drawn.

    Pixels go in blocks: what all of them need, and the usual crossings of one threshold, are loops that the
    compiler vectorises (`draw_ends`, `find_touching`, `next_crossings`); the rest is followed one by one.
    """
    pixels, motion = Pixels(voltage, pending, held, above, below), Motion(drift, noise)
    step, reset = Step(key, span_us, offset_us, first_pixel, width), Reset(dead_us, sigma)
    kicks, written = Kicks(kick_times_us, kick_sizes, slack), 0
    states, touching = np.empty(BLOCK, np.uint64), np.empty(BLOCK + 1, np.int32)
    start, end, a, b = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    noise2, wait, free, scratch = np.empty(BLOCK), np.zeros(BLOCK), np.zeros(BLOCK), np.empty((12, BLOCK))
    cuts = np.empty((2, DEEPEST + 1))
    for begin in range(first, count, BLOCK):
        block = near[begin : min(begin + BLOCK, count)]
        paths = Paths(block, states, start, end, a, b, noise2, wait, free)
        done = written
        sequences(key, first_pixel, block, states)
        normals(states[: block.shape[0]], start[: block.shape[0]], end[: block.shape[0]])
        if careful:
            find_waits(held, paths, span_us)
        draw_ends(pixels, motion, paths, span_us)
        touches = find_touching(paths, span_us, touching)
        if len(kick_sizes) > 0:
            touches = leave_out_kicked(touches, slack, block, touching)
            done = follow_all_kicked(paths, drift, step, reset, kicks, cuts, keys, done)
        if done >= 0:
            done = draw_crossings(touching[:touches], paths, step, reset, scratch, cuts, keys, done)
        if done < 0:
            return begin, written
        for k in range(block.shape[0]):
            voltage[block[k]] = end[k]
            pending[block[k]] = 0.0
        if careful:
            for k in range(block.shape[0]):
                held[block[k]] = max(free[k] - span_us, 0.0)
        written = done
    return count, written


@kernel
def find_waits(held: Any, paths: Any, span: Any) -> None:
    """Fill the paths' wait_us and free_us; their end, a normal number, is less by the wait."""
    pixels, wait, free, end = paths.pixels, paths.wait_us, paths.free_us, paths.end
    for k in range(pixels.shape[0]):
        free[k] = held[pixels[k]]
        wait[k] = min(free[k], span)
        end[k] *= math.sqrt(1.0 - wait[k] / span)


@kernel
def draw_ends(pixels: Any, motion: Any, paths: Any, span: Any) -> None:
    """The paths' start and end from standard normal numbers to voltages; above, below, noise2 are filled."""
    voltage, pending, thresholds = pixels.voltage, pixels.pending, (pixels.above, pixels.below)
    drift, noise, block, wait = motion.drift, motion.noise, paths.pixels, paths.wait_us
    start, end, a, b, noise2 = paths.start, paths.end, paths.above, paths.below, paths.noise2
    root, per_span = math.sqrt(span), 1.0 / span
    for k in range(block.shape[0]):
        i = block[k]
        sigma = np.float64(noise[i])
        a[k], b[k], noise2[k] = thresholds[0][i], thresholds[1][i], sigma * sigma
        x = np.float64(voltage[i]) + math.sqrt(np.float64(pending[i])) * start[k]
        x = min(max(x, -b[k]), a[k])  # beyond by rounding, by a kick, or where a threshold was lowered
        start[k] = x
        end[k] = x + np.float64(drift[i]) * ((span - wait[k]) * per_span) + sigma * root * end[k]


@kernel
def find_touching(paths: Any, span: Any, touching: Any) -> Any:
    """Fill touching with the places of the paths that may touch a threshold; returns their number."""
    start, end, a, b = paths.start, paths.end, paths.above, paths.below
    noise2, wait, paths_here = paths.noise2, paths.wait_us, paths.pixels.shape[0]
    inside = np.empty(paths_here, np.bool_)
    for k in range(paths_here):
        inside[k] = stays_inside(start[k], end[k], a[k], b[k], noise2[k] * (span - wait[k]))
    count = 0
    for k in range(paths_here):
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
def follow_all_kicked(
    paths: Any, drift: Any, step: Any, reset: Any, kicks: Any, cuts: Any, keys: Any, written: Any
) -> Any:
    """Follow a block's pixels with kicks, to the paths' end and free_us. Returns `written`, as `follow`."""
    end, free = paths.end, paths.free_us
    for k in range(paths.pixels.shape[0]):
        i = paths.pixels[k]
        if kicks.slack[i] > 0.0 and written >= 0:
            row, address = i // step.width, event_address(step.first_pixel + i, step.width, 1.0 / step.width)
            pixel = Pixel(paths.noise2[k], paths.above[k], paths.below[k], address, step.offset_us)
            written, end[k], free[k] = follow_kicked(
                paths.states[k], paths.start[k], np.float64(drift[i]), free[k], step.span_us, pixel, reset,
                kicks.times_us[:, row], kicks.sizes[:, row], cuts, keys, written,
            )  # fmt: skip
    return written
