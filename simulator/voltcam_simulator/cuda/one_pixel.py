"""One pixel over one step, as a thread does it: the kernels of a processor, given a band of one pixel.

Random numbers belong to a pixel and a step, and each number is worked out as it is for a whole band. So the
events are those of a processor, but where the device's exp, log or expm1 has another last bit.
"""

from typing import Any, NamedTuple

import numpy as np

from ..bent_crossings import Bent, cross_bent
from ..crossings import cross_straight
from ..groups import Bend, Kicks, Motion, Pixels
from ..kernel import kernel
from ..out_of_reach import accumulate_bent
from ..paper_law import cross_by_paper
from ..paths import Paths, Space

FLOATS, DOUBLES, INTS, MARKS = 33, 10, 8, 3
"""Columns of `Memory`."""


class Memory(NamedTuple):
    """What a thread has for itself: planes of one pixel, for a band and for its way through a step."""

    floats: Any
    """(FLOATS, 1) float32."""
    doubles: Any
    """(DOUBLES, 1) float64."""
    scratch: Any
    """(12, 1) float64."""
    ints: Any
    """(INTS, 2) int32."""
    marks: Any
    """(MARKS, 1) bool."""
    states: Any
    """(1,) uint64."""
    cuts: Any
    """(2, DEEPEST + 1) float64, see `single_path.follow`."""
    starts: Any
    """(MOST_PIECES + 1,) int64, see `Space`."""
    keys: Any
    """Space for events."""


class PixelBand(NamedTuple):
    """What effects work on, see `Band`; planes (1,) float32."""

    light_before: Any
    light: Any
    response: Any
    drift: Any
    noise: Any
    bow: Any
    rate: Any
    noise2: Any
    leak: Any
    copies: Any
    """(2, 1)."""


@kernel
def pixel_band(floats: Any, light_before: Any, leak: Any) -> Any:
    """An empty one, in `Memory.floats`."""
    f = floats
    for k in range(9):
        f[k, 0] = 0
    return PixelBand(light_before, f[0], f[1], f[2], f[3], f[4], f[5], f[6], leak, f[7:9])


@kernel
def own_pixel(floats: Any, pixels: Any, i: Any) -> Any:
    """A copy of pixel i of the `Pixels`, to be put back only when its events have found room."""
    f = floats
    f[9, 0], f[10, 0], f[11, 0] = pixels.voltage[i], pixels.pending[i], pixels.held[i]
    f[12, 0], f[13, 0] = pixels.above[i], pixels.below[i]
    return Pixels(f[9], f[10], f[11], f[12], f[13])


@kernel
def put_back(own: Any, pixels: Any, i: Any) -> None:
    """The pixel, at the end of the step."""
    pixels.voltage[i], pixels.pending[i], pixels.held[i] = own.voltage[0], own.pending[0], own.held[0]


@kernel
def kicks_of_row(kicks: Any, row: Any) -> Any:
    """Those of a pixel in that row; the slack of kicks here is (rows,)."""
    return Kicks(kicks.times_us[:, row : row + 1], kicks.sizes[:, row : row + 1], kicks.slack[row : row + 1])


@kernel
def cross_pixel(
    own: Any, drift: Any, noise: Any, bow: Any, rate: Any, step: Any, reset: Any, kicks: Any, careful: Any,
    memory: Any,
) -> Any:  # fmt: skip
    """Take a pixel through a step: what `band_step` does to a band.

    own: its `Pixels`; drift: without kicks, which are added. Returns how many events are in memory.keys, -1
    where they do not fit, with the pixel unchanged.
    """
    f, ints, marks = memory.floats, memory.ints, memory.marks
    in_reach = Pixels(own.voltage, own.pending, own.held, f[14], f[15])
    f[14, 0], f[15, 0] = own.above[0], own.below[0]
    if kicks.sizes.shape[0] > 0:
        total = 0.0
        for kick in range(kicks.sizes.shape[0]):
            total += kicks.sizes[kick, 0]
        drift[0] = np.float32(np.float64(drift[0]) + total)
        f[14, 0], f[15, 0] = own.above[0] - kicks.slack[0], own.below[0] - kicks.slack[0]
    motion, bend, span = Motion(drift, noise), Bend(bow, rate), np.float32(step.span_us)
    straight, curved = accumulate_bent(
        in_reach, drift, noise, bow, span, marks[0], marks[1], ints[0], ints[1], 0
    )
    if straight + curved == 0:
        return 0
    d = memory.doubles
    paths = Paths(
        ints[2], ints[3], d[0], d[1], d[2], d[3], memory.states, d[4], d[5], d[6], d[7], d[8], d[9],
    )  # fmt: skip
    space = Space(
        ints[4], ints[5], marks[2], memory.scratch, f[16], memory.cuts, memory.starts,
    )  # fmt: skip
    keys = memory.keys
    if straight > 0:
        paths.begin_us[0], paths.end_us[0] = 0.0, step.span_us
        return cross_straight(ints[0, :1], paths, own, motion, step, reset, kicks, careful, space, keys, 0)
    bent = Bent(
        ints[6], Pixels(f[17], f[18], f[19], f[20], f[21]), f[22], f[23], f[24], f[25], f[26], f[27], f[28],
        f[29], f[30:32], f[32],
    )  # fmt: skip
    return cross_bent(
        ints[1, :1], bent, paths, own, motion, step, reset, kicks, bend, careful, space, keys, 0
    )


@kernel
def cross_pixel_by_paper(own: Any, drift: Any, noise: Any, step: Any, keys: Any) -> Any:
    """The same by the law of the paper."""
    done, written = cross_by_paper(
        own.voltage, own.pending, own.held, own.above, own.below, drift, noise, step.key, step.span_us,
        step.offset_us, step.first_pixel, step.width, 0, keys,
    )  # fmt: skip
    return written if done > 0 else -1
