"""The pixels near a threshold over one step: their paths drawn in blocks."""

from typing import Any

from .bent_crossings import cross_bent, fresh_bent
from .groups import Bend, Kicks, Motion, Pixels, Reset, Step
from .kernel import kernel
from .paths import BLOCK, cross_block, fresh_paths, fresh_space, gather, some


@kernel
def cross(
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, drift: Any, noise: Any,
    key: Any, span_us: Any, offset_us: Any, first_pixel: Any, width: Any, dead_us: Any, sigma: Any,
    kick_times_us: Any, kick_sizes: Any, slack: Any, bow: Any, rate: Any, careful: Any,
    straight: Any, bent: Any, first: Any, keys: Any,
) -> Any:  # fmt: skip
    """Draw the paths of pixels near a threshold and pack their events into keys.

    Called as cross(*pixels, *motion, *step, *reset, *kicks, *bend, careful, straight, bent, first, keys), see
    `groups`. careful: False when no pixel is held or kicked. straight, bent: int32, the numbers of pixels
    whose mean path is straight, and bent; counted through, those before `first` are done already.
    Returns (pixels done, events written). Stops before a block of pixels whose events do not fit into keys
    (capacity,) uint64; call again with more room, the same numbers are drawn.
    """
    pixels, motion = Pixels(voltage, pending, held, above, below), Motion(drift, noise)
    step, reset = Step(key, span_us, offset_us, first_pixel, width), Reset(dead_us, sigma)
    kicks = Kicks(kick_times_us, kick_sizes, slack)
    paths, space, written, count = fresh_paths(), fresh_space(), 0, straight.shape[0]
    paths.begin_us[: min(count, BLOCK)] = 0.0  # not more: a small sensor feels it
    paths.end_us[: min(count, BLOCK)] = span_us
    for begin in range(first, count, BLOCK):
        block = straight[begin : min(begin + BLOCK, count)]
        done = cross_straight(block, paths, pixels, motion, step, reset, kicks, careful, space, keys, written)
        if done < 0:
            return begin, written
        written = done
    if bow is not None:
        bend, own = Bend(bow, rate), fresh_bent()
        for begin in range(max(first - count, 0), bent.shape[0], BLOCK):
            block = bent[begin : min(begin + BLOCK, bent.shape[0])]
            done = cross_bent(
                block, own, paths, pixels, motion, step, reset, kicks, bend, careful, space, keys, written
            )
            if done < 0:
                return count + begin, written
            written = done
    return count + bent.shape[0], written


@kernel
def cross_straight(
    block: Any, paths: Any, pixels: Any, motion: Any, step: Any, reset: Any, kicks: Any, careful: Any,
    space: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """A block of pixels whose paths go straight over the whole step. Returns `written`, -1 if keys is full.

    begin_us and end_us of paths are those of the step.
    """
    here = some(paths, block, block)
    gather(motion.drift, block, here.drift)
    gather(motion.noise, block, here.noise2)
    for k in range(block.shape[0]):
        here.noise2[k] *= here.noise2[k]
    return cross_block(here, pixels, step.key, step, reset, kicks, careful, space, keys, written)
