"""The kernels that are launched: a thread for each pixel of the sensor. Arrays come in groups."""

import functools
from typing import Any, NamedTuple

import numpy as np

from ..bends import MOST_PIECES
from ..groups import Motion, Place, Step
from ..law import Law
from ..out_of_reach import add_response
from ..single_path import DEEPEST
from ..stationary import start_voltage
from .one_pixel import (
    DOUBLES,
    FLOATS,
    INTS,
    MARKS,
    Memory,
    cross_pixel,
    cross_pixel_by_paper,
    kicks_of_row,
    own_pixel,
    pixel_band,
    put_back,
)
from .target import cuda, launched, on_device

OWN_KEYS = 16
"""Events that a thread has space for; a pixel with more in a step is followed again with more."""
CUTS, STARTS = DEEPEST + 1, MOST_PIECES + 1
CLAIMED, UNCLAIMED, LATE = 0, 1, 2
"""Places in `Output.counts`."""
compiled_once = functools.lru_cache(maxsize=64)
"""A kernel takes seconds to compile, so all sensors of a process share it."""


class Seen(NamedTuple):
    """What the sensor saw last; planes of all pixels, float32."""

    light: Any
    response: Any
    leak: Any
    """Of each pixel; of one pixel where all are 1."""


class Frames(NamedTuple):
    """A straight line in time from one frame to the next; (pixels,) uint8 or float32."""

    before: Any
    after: Any
    share: Any
    """Of the way, at the end of the step; float32."""


class Given(NamedTuple):
    """What the function of the effects is given, see `program`."""

    planes: Any
    tables: Any
    numbers: Any


class Output(NamedTuple):
    """Where events go, and which pixels did not get theirs in."""

    keys: Any
    """uint64."""
    counts: Any
    """int64: keys claimed; the first place claimed that did not fit; pixels that are late."""
    numbers: Any
    """(pixels,) int32: those that are late."""
    motion: Any
    """(4, pixels) float32: their drift, noise, bow and rate."""


class Late(NamedTuple):
    """Pixels to be followed once more, with more room."""

    numbers: Any
    """int32."""
    motion: Any
    """See `Output`."""
    first: Any
    """The first of them whose turn it is."""
    count: Any
    """How many there are."""
    room: Any
    """(threads, keys) uint64."""


@on_device
def deliver(keys: Any, written: Any, output: Any) -> Any:
    """Put a pixel's events with those of others; False where they do not fit."""
    if written <= 0:
        return written == 0
    at = cuda.atomic.add(output.counts, CLAIMED, written)
    if at + written > output.keys.shape[0]:
        cuda.atomic.min(output.counts, UNCLAIMED, at)
        return False
    for k in range(written):
        output.keys[at + k] = keys[k]
    return True


@on_device
def be_late(i: Any, drift: Any, noise: Any, bow: Any, rate: Any, output: Any) -> None:
    """Note a pixel whose events did not fit."""
    output.numbers[cuda.atomic.add(output.counts, LATE, 1)] = i
    output.motion[0, i], output.motion[1, i] = drift, noise
    output.motion[2, i], output.motion[3, i] = bow[0], rate[0]


@on_device
def light_of(frames: Any, i: Any) -> Any:
    """The grey level of a pixel at the end of the step."""
    before, after, share = np.float32(frames.before[i]), np.float32(frames.after[i]), frames.share
    return after if share >= np.float32(1) else (np.float32(1) - share) * before + share * after


@compiled_once
def settling(effects: Any) -> Any:
    """The kernel that shows a sensor an image as if it had been there for long."""

    @launched
    def settle(seen: Any, frames: Any, given: Any, width: Any) -> None:
        i = cuda.grid(1)
        if i >= seen.light.shape[0]:
            return
        floats = cuda.local.array((FLOATS, 1), np.float32)
        k = i % seen.leak.shape[0]
        band = pixel_band(floats, seen.light[i : i + 1], seen.leak[k : k + 1])
        band.light[0] = light_of(frames, i)
        place = Place(i // width, i % width, 1, 1)
        effects(band, place, given.planes, given.tables, given.numbers, i)
        seen.light[i], seen.response[i] = band.light[0], band.response[0]

    return settle


@compiled_once
def starting(effects: Any) -> Any:
    """The kernel that puts the voltages where they are after long."""

    @launched
    def start(pixels: Any, seen: Any, given: Any, key: Any, width: Any) -> None:
        i = cuda.grid(1)
        if i >= seen.light.shape[0]:
            return
        floats = cuda.local.array((FLOATS, 1), np.float32)
        k = i % seen.leak.shape[0]
        band = pixel_band(floats, seen.light[i : i + 1], seen.leak[k : k + 1])
        band.light[0] = seen.light[i]
        place = Place(i // width, i % width, 1, 1)
        effects(band, place, given.planes, given.tables, given.numbers, i)
        own = own_pixel(floats, pixels, i)
        start_voltage(own, Motion(band.drift, band.noise), key, i)
        put_back(own, pixels, i)

    return start


@compiled_once
def stepping(effects: Any, law: Law) -> Any:
    """The kernel of a step: what effects do to light and voltage, and the way of the voltage."""
    follow = _following(law)

    @launched
    def step_all(
        pixels: Any, seen: Any, frames: Any, given: Any, step: Any, reset: Any, kicks: Any, careful: Any,
        output: Any,
    ) -> None:  # fmt: skip
        i = cuda.grid(1)
        if i >= seen.light.shape[0]:
            return
        floats = cuda.local.array((FLOATS, 1), np.float32)
        keys = cuda.local.array(OWN_KEYS, np.uint64)
        k = i % seen.leak.shape[0]
        band = pixel_band(floats, seen.light[i : i + 1], seen.leak[k : k + 1])
        band.light[0] = light_of(frames, i)
        row = i // step.width
        effects(band, Place(row, i % step.width, 1, 1), given.planes, given.tables, given.numbers, i)
        add_response(band.light, band.response, band.drift, seen.light[i : i + 1], seen.response[i : i + 1])
        drift, noise = band.drift[0], band.noise[0]
        own = own_pixel(floats, pixels, i)
        own_step = Step(step.key, step.span_us, step.offset_us, i, step.width)
        written = follow(own, band, own_step, reset, kicks_of_row(kicks, row), careful, floats, keys)
        if deliver(keys, written, output):
            put_back(own, pixels, i)
        else:
            be_late(i, drift, noise, band.bow, band.rate, output)

    return step_all


@compiled_once
def stepping_late(law: Law) -> Any:
    """The kernel for pixels whose events did not fit; again they may not."""
    follow = _following(law)

    @launched
    def step_late(
        pixels: Any, seen: Any, step: Any, reset: Any, kicks: Any, careful: Any, late: Any, output: Any,
    ) -> None:  # fmt: skip
        thread = cuda.grid(1)
        if thread >= late.room.shape[0] or late.first + thread >= late.count:
            return
        floats = cuda.local.array((FLOATS, 1), np.float32)
        i = np.int64(late.numbers[late.first + thread])
        band = pixel_band(floats, seen.light[i : i + 1], seen.leak[0:1])
        band.drift[0], band.noise[0] = late.motion[0, i], late.motion[1, i]
        band.bow[0], band.rate[0] = late.motion[2, i], late.motion[3, i]
        own, keys = own_pixel(floats, pixels, i), late.room[thread]
        row = i // step.width
        own_step = Step(step.key, step.span_us, step.offset_us, i, step.width)
        written = follow(own, band, own_step, reset, kicks_of_row(kicks, row), careful, floats, keys)
        if deliver(keys, written, output):
            put_back(own, pixels, i)
        else:
            be_late(i, late.motion[0, i], late.motion[1, i], band.bow, band.rate, output)

    return step_late


def _following(law: Law) -> Any:
    """The way of one pixel's voltage over a step, by a law."""
    return _follow_by_paper if law == "paper" else _follow


@on_device
def _follow(
    own: Any, band: Any, step: Any, reset: Any, kicks: Any, careful: Any, floats: Any, keys: Any
) -> Any:
    doubles = cuda.local.array((DOUBLES, 1), np.float64)
    scratch = cuda.local.array((12, 1), np.float64)
    ints = cuda.local.array((INTS, 2), np.int32)
    marks = cuda.local.array((MARKS, 1), np.bool_)
    states = cuda.local.array(1, np.uint64)
    cuts = cuda.local.array((2, CUTS), np.float64)
    starts = cuda.local.array(STARTS, np.int64)
    memory = Memory(floats, doubles, scratch, ints, marks, states, cuts, starts, keys)
    return cross_pixel(own, band.drift, band.noise, band.bow, band.rate, step, reset, kicks, careful, memory)


@on_device
def _follow_by_paper(
    own: Any, band: Any, step: Any, reset: Any, kicks: Any, careful: Any, floats: Any, keys: Any
) -> Any:
    return cross_pixel_by_paper(own, band.drift, band.noise, step, keys)
