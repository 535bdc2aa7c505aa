"""The pixels near a threshold whose paths are bent over a step: drawn in straight pieces."""

from typing import Any, NamedTuple

import numpy as np

from .bends import count_pieces, fading, find_knots
from .groups import Pixels
from .kernel import kernel
from .out_of_reach import REACH
from .paths import BLOCK, cross_block, gather, some
from .random import mix

_0 = np.float32(0)


class Bent(NamedTuple):
    """A block of pixels whose mean paths are bent, over a step; (BLOCK,) float32, the first m are in use.

    Those with more pieces come first.
    """

    numbers: Any
    """int32: which pixels of the band."""
    pixels: Any
    """A `Pixels` of them alone, which follows them from piece to piece."""
    drift: Any
    """Voltage gained over the whole step, without kicks."""
    noise2: Any
    """sigma^2 [1/us]."""
    bow: Any
    """See `Bend`."""
    rate: Any
    """See `Bend`."""
    q: Any
    """See `bends`."""
    pieces: Any
    """Into how many pieces the step is cut."""
    share: Any
    """What of the step the pieces so far have taken."""
    line: Any
    """How far the path is from the straight line there, in bows."""
    ahead: Any
    """(2, BLOCK): share and line at the end of the next piece."""
    gain: Any
    """Voltage gained over the next piece, with kicks."""


@kernel
def fresh_bent() -> Any:
    """Space for a block."""
    columns = np.empty((16, BLOCK), np.float32)
    pixels = Pixels(columns[0], columns[1], columns[2], columns[3], columns[4])
    return Bent(
        np.empty(BLOCK, np.int32), pixels, columns[5], columns[6], columns[7], columns[8], columns[9],
        columns[10], columns[11], columns[12], columns[13:15], columns[15],
    )  # fmt: skip


@kernel
def cross_bent(
    block: Any, bent: Any, paths: Any, pixels: Any, motion: Any, step: Any, reset: Any, kicks: Any, bend: Any,
    careful: Any, space: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """A block of pixels with bent paths, in straight pieces. Returns `written`, -1 when keys is full.

    The pixels themselves change only when all pieces are done.
    """
    most = begin_bent(block, bent, pixels, motion, bend, step.span_us, space)
    key, count = step.key, block.shape[0]
    if len(kicks.sizes) > 0:
        take_out_kicks(count, bent, step.width, kicks)
    for piece in range(most):
        while bent.pieces[count - 1] <= piece:
            count -= 1
        going = begin_piece(piece, count, bent, paths, step, kicks, space)
        here = some(paths, paths.numbers[:going], paths.places[:going])
        written = cross_block(here, bent.pixels, key, step, reset, kicks, careful, space, keys, written)
        if written < 0:
            return -1
        key = mix(key)
    for k in range(block.shape[0]):
        i = bent.numbers[k]
        pixels.voltage[i], pixels.pending[i] = bent.pixels.voltage[k], bent.pixels.pending[k]
    if careful:
        for k in range(block.shape[0]):
            pixels.held[bent.numbers[k]] = bent.pixels.held[k]
    return written


@kernel
def begin_bent(block: Any, bent: Any, pixels: Any, motion: Any, bend: Any, span_us: Any, space: Any) -> Any:
    """Take the pixels of a block, and cut their step into pieces; returns the most of any pixel."""
    n = block.shape[0]
    q, pieces = bent.q[:n], bent.pieces[:n]
    gather_bent(block, bent, motion, bend)
    most = count_pieces(bent.bow, bent.drift, bent.rate, q, span_us, pieces)
    by_pieces(pieces, most, block, bent.numbers, space.starts)
    numbers, own = bent.numbers[:n], bent.pixels
    gather_bent(numbers, bent, motion, bend)
    count_pieces(bent.bow, bent.drift, bent.rate, q, span_us, pieces)
    gather(pixels.voltage, numbers, own.voltage)
    gather(pixels.pending, numbers, own.pending)
    gather(pixels.held, numbers, own.held)
    gather(pixels.above, numbers, own.above)
    gather(pixels.below, numbers, own.below)
    gather(motion.noise, numbers, bent.noise2)
    for k in range(n):
        bent.noise2[k] *= bent.noise2[k]
        bent.share[k], bent.line[k] = _0, _0
    return most


@kernel
def gather_bent(numbers: Any, bent: Any, motion: Any, bend: Any) -> None:
    """What the pieces of these pixels depend on."""
    gather(motion.drift, numbers, bent.drift)
    gather(bend.bow, numbers, bent.bow)
    gather(bend.rate, numbers, bent.rate)
    for k in range(numbers.shape[0]):
        bent.q[k] = fading(bent.rate[k])


@kernel
def by_pieces(pieces: Any, most: Any, block: Any, numbers: Any, starts: Any) -> None:
    """Put the pixels of a block into numbers, those with more pieces first; starts: see `Space`."""
    for i in range(most + 1):
        starts[i] = 0
    for k in range(pieces.shape[0]):
        starts[most - int(pieces[k]) + 1] += 1
    for i in range(most):
        starts[i + 1] += starts[i]
    for k in range(pieces.shape[0]):
        i = most - int(pieces[k])
        numbers[starts[i]] = block[k]
        starts[i] += 1


@kernel
def begin_piece(piece: Any, n: Any, bent: Any, paths: Any, step: Any, kicks: Any, space: Any) -> Any:
    """Fill paths with the next piece of those of the first n pixels that may fire; returns their number.

    Where no threshold is within reach over the piece, drift and noise gather.
    """
    own, span, share, line, gain = bent.pixels, step.span_us, bent.share, bent.line, bent.gain
    share_end, line_end = bent.ahead[0, :n], bent.ahead[1, :n]
    find_knots(piece + 1, bent.pieces, bent.rate, bent.q, share_end, line_end, space.small)
    for k in range(n):
        gain[k] = bent.drift[k] * (share_end[k] - share[k]) + bent.bow[k] * (line_end[k] - line[k])
    may_stay = space.marks[:n]
    for k in range(n):
        may_stay[k] = True
    if len(kicks.sizes) > 0:
        add_kicks(n, bent, step, kicks, may_stay)
    count = stay(own, gain, bent.noise2, share_end, share, span, may_stay, space.small, paths.places)
    for c in range(count):
        k = paths.places[c]
        paths.numbers[c] = bent.numbers[k]
        paths.begin_us[c], paths.end_us[c] = span * share[k], span * share_end[k]
        paths.drift[c], paths.noise2[c] = gain[k], bent.noise2[k]
    for k in range(n):
        share[k] = share_end[k]
        line[k] = line_end[k]
    return count


@kernel
def stay(
    pixels: Any, gain: Any, noise2: Any, share_end: Any, share: Any, span_us: Any, stays: Any, variance: Any,
    others: Any,
) -> Any:  # fmt: skip
    """Let drift and noise gather, over a piece, where no threshold is within reach; others receives the
    places of the other pixels. Returns their number. stays (n,) bool: at first which pixels are looked at,
    at last which of them stay; variance (n or more,) is worked on."""
    voltage, pending, held, n = pixels.voltage, pixels.pending, pixels.held, stays.shape[0]
    above, below, span, reach2 = pixels.above, pixels.below, np.float32(span_us), np.float32(REACH * REACH)
    for k in range(n):
        variance[k] = pending[k] + noise2[k] * (share_end[k] - share[k]) * span
    for k in range(n):
        start, end = voltage[k], voltage[k] + gain[k]
        closest = min(above[k] - max(start, end), below[k] + min(start, end))
        stays[k] &= (closest > _0) & (closest * closest > reach2 * variance[k])
    for k in range(n):
        stays[k] &= held[k] <= _0
    for k in range(n):
        voltage[k] += gain[k] if stays[k] else _0
    for k in range(n):
        pending[k] = variance[k] if stays[k] else pending[k]
    count = 0
    for k in range(n):
        others[count] = k
        count += not stays[k]
    return count


@kernel
def take_out_kicks(n: Any, bent: Any, width: Any, kicks: Any) -> None:
    """Those of the step, of its drift."""
    for k in range(n):
        if kicks.slack[bent.numbers[k]] > 0.0:
            total, row = 0.0, bent.numbers[k] // width
            for kick in range(kicks.sizes.shape[0]):
                total += kicks.sizes[kick, row]
            bent.drift[k] -= total


@kernel
def add_kicks(n: Any, bent: Any, step: Any, kicks: Any, may_stay: Any) -> None:
    """Those in the next piece, to its gain; pixels with kicks may not stay as they are."""
    for k in range(n):
        if kicks.slack[bent.numbers[k]] > 0.0:
            may_stay[k] = False
            row = bent.numbers[k] // step.width
            begin, end = bent.share[k] * step.span_us, bent.ahead[0, k] * step.span_us
            for kick in range(kicks.sizes.shape[0]):
                if begin < kicks.times_us[kick, row] <= end:
                    bent.gain[k] += kicks.sizes[kick, row]
