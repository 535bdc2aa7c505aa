"""The straight paths of a block of pixels: drawn all at once, one after the other where it must be.

What all of them need, and the usual crossings of one threshold, are loops that the compiler vectorises
(`draw_ends`, `find_touching`, `next_crossings`); the rest is followed one by one.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from .bends import MOST_PIECES
from .crossing_rounds import draw_crossings
from .event_key import event_address
from .first_passage import stays_inside
from .kernel import kernel
from .random import normals, sequences
from .single_path import DEEPEST, Pixel, follow_kicked

BLOCK = 8192
"""Pixels that are drawn together. A block of 2048 stays in the second cache, but pixels with many pieces are
few in it, and loops over few cost what each loop costs by itself: 8192 are drawn a quarter faster."""


class Paths(NamedTuple):
    """Straight paths of pixels over a step or a piece of it; (m,) float64 where nothing else is said.

    Times count from the start of the step [us].
    """

    numbers: Any
    """int32: which pixels of the band."""
    places: Any
    """int32: where they are in the `Pixels` that belong to them."""
    begin_us: Any
    """When the path begins."""
    end_us: Any
    """When it ends."""
    drift: Any
    """Voltage gained on the way, with kicks, if the pixel has no dead time."""
    noise2: Any
    """sigma^2 [1/us]."""
    states: Any
    """uint64: the sequences of random numbers."""
    start: Any
    """Voltage at the start of the path."""
    end: Any
    """Voltage at its end, first without resets, at last with them."""
    above: Any
    """The ON threshold."""
    below: Any
    """The OFF threshold, as a distance from 0."""
    left_us: Any
    """How much of its time is left behind the dead time with which it begins."""
    free_us: Any
    """When the dead time ends: that before it, at last that of its events."""


class Space(NamedTuple):
    """What is worked on within a block."""

    touching: Any
    """(BLOCK + 1,) int32: which paths may touch a threshold."""
    again: Any
    """(BLOCK + 1,) int32: and which may once more."""
    marks: Any
    """(BLOCK,) bool."""
    scratch: Any
    """(12, BLOCK) float64."""
    small: Any
    """(BLOCK,) float32."""
    cuts: Any
    """(2, DEEPEST + 1) float64, see `single_path.follow`."""
    starts: Any
    """(MOST_PIECES + 1,) int64."""


@kernel
def fresh_paths() -> Any:
    """Space for a block of paths."""
    counts, planes = np.empty((2, BLOCK), np.int32), np.empty((10, BLOCK))
    return Paths(
        counts[0], counts[1], planes[0], planes[1], planes[2], planes[3], np.empty(BLOCK, np.uint64),
        planes[4], planes[5], planes[6], planes[7], planes[8], planes[9],
    )  # fmt: skip


@kernel
def fresh_space() -> Any:
    """Space to work on a block."""
    return Space(
        np.empty(BLOCK + 1, np.int32), np.empty(BLOCK + 1, np.int32), np.empty(BLOCK, np.bool_),
        np.empty((12, BLOCK)), np.empty(BLOCK, np.float32), np.empty((2, DEEPEST + 1)),
        np.empty(MOST_PIECES + 1, np.int64),
    )  # fmt: skip


@kernel
def some(paths: Any, numbers: Any, places: Any) -> Any:
    """As many of them as there are numbers and places, for which the other columns stand."""
    count = numbers.shape[0]
    return Paths(
        numbers, places, paths.begin_us[:count], paths.end_us[:count],
        paths.drift[:count], paths.noise2[:count], paths.states[:count], paths.start[:count],
        paths.end[:count], paths.above[:count], paths.below[:count], paths.left_us[:count],
        paths.free_us[:count],
    )  # fmt: skip


@kernel
def cross_block(
    paths: Any, pixels: Any, key: Any, step: Any, reset: Any, kicks: Any, careful: Any, space: Any, keys: Any,
    written: Any,
) -> Any:  # fmt: skip
    """Draw paths of which numbers, places, begin_us, end_us, drift and noise2 are filled.

    pixels, the `Pixels` that their places point into, become those at the ends; key: of the random numbers.
    Events go to keys[written:]. Returns `written`, -1 with pixels unchanged when keys is full.
    """
    places = paths.places
    sequences(key, step.first_pixel, paths.numbers, paths.states)
    normals(paths.states, paths.start, paths.end)
    draw_ends(pixels, paths, careful, space.scratch)
    touches = find_touching(paths, space.marks, space.touching)
    if len(kicks.sizes) > 0:
        touches = leave_out_kicked(touches, kicks.slack, paths.numbers, space.touching)
        written = follow_all_kicked(paths, step, reset, kicks, space.cuts, keys, written)
    if written >= 0:
        touching = space.touching[:touches]
        written = draw_crossings(touching, paths, step, reset, space, keys, written)
    if written < 0:
        return -1
    for k in range(places.shape[0]):
        pixels.voltage[places[k]] = paths.end[k]
        pixels.pending[places[k]] = 0.0
    if careful:
        for k in range(places.shape[0]):
            pixels.held[places[k]] = max(paths.free_us[k] - paths.end_us[k], 0.0)
    return written


@kernel
def draw_ends(pixels: Any, paths: Any, careful: Any, scratch: Any) -> None:
    """The paths' start and end from standard normal numbers to voltages; their other columns are filled.

    Each loop fills few columns: the compiler vectorises it as long as it has few pairs of arrays to tell
    apart, and would not one that does all at once.
    """
    places, n = paths.places, paths.places.shape[0]
    begin, until, left, free = paths.begin_us, paths.end_us, paths.left_us, paths.free_us
    start, end, a, b, drift, noise2 = (
        paths.start,
        paths.end,
        paths.above,
        paths.below,
        paths.drift,
        paths.noise2,
    )
    voltage, pending = scratch[0, :n], scratch[1, :n]
    gather(pixels.voltage, places, voltage)
    gather(pixels.pending, places, pending)
    gather(pixels.above, places, a)
    gather(pixels.below, places, b)
    for k in range(n):
        left[k] = until[k] - begin[k]
    if careful:
        gather(pixels.held, places, free)
        for k in range(n):
            left[k] = max(left[k] - free[k], 0.0)
            free[k] += begin[k]
    else:
        for k in range(n):
            free[k] = begin[k]
    for k in range(n):
        x = voltage[k] + math.sqrt(pending[k]) * start[k]
        start[k] = min(max(x, -b[k]), a[k])  # beyond by rounding, a kick, or where a threshold was lowered
    for k in range(n):
        gained = drift[k] * (left[k] / (until[k] - begin[k]))
        end[k] = start[k] + gained + math.sqrt(noise2[k] * left[k]) * end[k]


@kernel
def gather(plane: Any, places: Any, column: Any) -> None:
    """column[k] = plane[places[k]]."""
    for k in range(places.shape[0]):
        column[k] = plane[places[k]]


@kernel
def find_touching(paths: Any, inside: Any, touching: Any) -> Any:
    """Fill touching with the places of the paths that may touch a threshold; returns their number.

    inside (n or more,) bool: is worked on.
    """
    start, end, a, b = paths.start, paths.end, paths.above, paths.below
    noise2, left, count = paths.noise2, paths.left_us, paths.places.shape[0]
    for k in range(count):
        inside[k] = stays_inside(start[k], end[k], a[k], b[k], noise2[k] * left[k])
    found = 0
    for k in range(count):
        touching[found] = k
        found += not inside[k]
    return found


@kernel
def leave_out_kicked(count: Any, slack: Any, numbers: Any, touching: Any) -> Any:
    """Take pixels with kicks out of the first `count` of touching; returns how many are left."""
    left = 0
    for c in range(count):
        touching[left] = touching[c]
        left += slack[numbers[touching[c]]] <= 0.0
    return left


@kernel
def follow_all_kicked(
    paths: Any, step: Any, reset: Any, kicks: Any, cuts: Any, keys: Any, written: Any
) -> Any:
    """Follow a block's pixels with kicks, to the paths' end and free_us. Returns `written`, as `follow`."""
    end, free = paths.end, paths.free_us
    for k in range(paths.places.shape[0]):
        i = paths.numbers[k]
        if kicks.slack[i] > 0.0 and written >= 0:
            row, address = i // step.width, event_address(step.first_pixel + i, step.width, 1.0 / step.width)
            pixel = Pixel(paths.noise2[k], paths.above[k], paths.below[k], address, step.offset_us)
            written, end[k], free[k] = follow_kicked(
                paths.states[k], paths.start[k], paths.drift[k], free[k], paths.begin_us[k],
                paths.end_us[k], pixel, reset, kicks.times_us[:, row], kicks.sizes[:, row], cuts, keys,
                written,
            )  # fmt: skip
    return written
