"""A pixel over one step: the lazy sweep over all pixels, and the drawn paths of those near a barrier.

Noise is lazy: while both barriers are more than `REACH` pending standard deviations away nothing can
happen, so drift adds to a mean and noise to a pending variance, and nothing is drawn (`gather`). For the
other pixels the voltage is drawn and the path followed event by event (`cross`), by the laws of
`first_passage`.
"""

import math
from typing import Any

import numpy as np

from .event_key import event_address, event_key
from .first_passage import exit_of_bridge, needs_cut, stays_inside
from .kernel import kernel
from .random import normal, sequence

REACH = 7.4
"""Standard deviations beyond which a barrier is out of reach: 4 Q(7.4) < 3e-13."""
DEEPEST = 64
"""Halvings of an interval after which its two ends are the same number."""


@kernel
def gather(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, held: Any,
    slack: Any, near: Any,
) -> Any:  # fmt: skip
    """Let drift and noise gather where no barrier is within reach.

    All arrays (pixels,) float32; held: dead time left [us]; slack: how far the mean path may go beyond its
    two ends; near (pixels + 1,) int32 receives the indices of the other pixels, which stay as they were.
    Returns their number. Two loops, because the first is then vectorised.
    """
    reach2 = np.float32(REACH * REACH)
    far = np.empty(voltage.shape[0], np.bool_)
    for i in range(voltage.shape[0]):
        start = voltage[i]
        end = start + drift[i]
        variance = pending[i] + noise[i] * noise[i] * span
        closest = min(above[i] - max(start, end), below[i] + min(start, end)) - slack
        far[i] = (closest > 0) & (closest * closest > reach2 * variance) & (held[i] <= 0)
        voltage[i] = end if far[i] else start
        pending[i] = variance if far[i] else pending[i]
    count = 0
    for i in range(voltage.shape[0]):
        near[count] = i
        count += not far[i]
    return count


@kernel
def cross(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, held: Any,
    near: Any, first: Any, count: Any, key: Any, pixel0: Any, width: Any, period: Any, reset_sigma: Any,
    kick_times: Any, kick_sizes: Any, offset: Any, keys: Any,
) -> Any:  # fmt: skip
    """Draw the paths of the pixels near[first:count] and pack their events into keys.

    key: `interval_key` of the step; pixel0: number of the band's first pixel; period [us]: dead time after an
    event; reset_sigma: spread of the voltage after a reset. kick_times (kicks, rows) [us], ascending, and
    kick_sizes (kicks,): sudden changes of voltage. offset [us]: start of the step in its interval.
    Returns (pixels done, events written). Stops before the pixel whose events do not fit into keys
    (capacity,) uint64; call again with more room, the same numbers are drawn.
    """
    written = 0
    kicks = kick_sizes.shape[0]
    cuts = np.empty((2, DEEPEST + 1))
    for k in range(first, count):
        i = near[k]
        state = sequence(key, pixel0 + i)
        above_i, below_i = np.float64(above[i]), np.float64(below[i])
        noise2 = np.float64(noise[i]) * np.float64(noise[i])
        slope = np.float64(drift[i]) / span
        x = np.float64(voltage[i])
        if pending[i] > 0.0:
            state, gauss = normal(state)
            x += math.sqrt(pending[i]) * gauss
        now, done = np.float64(held[i]), written
        row = i // width if kicks > 0 else 0
        address = event_address(pixel0 + i, width)
        for kick in range(kicks + 1):  # the path up to each kick, and to the end
            end = span if kick == kicks else kick_times[kick, row]
            if end > now:
                x = min(max(x, -below_i), above_i)  # beyond by a kick, rounding, or a threshold lowered
                state, gauss = normal(state)
                variance = noise2 * (end - now)
                y = x + slope * (end - now) + math.sqrt(variance) * gauss
                if stays_inside(x, y, above_i, below_i, variance):
                    x, now = y, end
                else:
                    state, done, x, now = follow(
                        state, x, y, now, end, noise2, above_i, below_i, period, reset_sigma,
                        address, offset, cuts, keys, done,
                    )  # fmt: skip
                    if done < 0:
                        return k, written
            if kick < kicks and now <= end:  # in its dead time a pixel memorises the kick
                x += kick_sizes[kick]
        written = done
        voltage[i] = x
        pending[i] = 0.0
        held[i] = max(now - span, 0.0)
    return count, written


@kernel
def follow(
    state: Any, x: Any, y: Any, begin: Any, end: Any, noise2: Any, above: Any, below: Any, period: Any,
    reset_sigma: Any, address: Any, offset: Any, cuts: Any, keys: Any, written: Any,
) -> Any:  # fmt: skip
    """All events of one pixel from begin to end, its path going from x to y if there were no resets.

    noise2: sigma^2 [1/us]; times [us]; cuts (2, DEEPEST + 1): room for the ends of bridges that were cut.
    Fills keys[written:]. Returns (state, written, voltage at the end, time from which the pixel is free: end,
    or later by what is left of its dead time); written is -1 when keys is full.
    """
    times, voltages = cuts[0], cuts[1]
    times[0], voltages[0] = end, y
    depth, now, fallen = 0, begin, 0.0  # fallen: what resets have subtracted from the path so far
    while depth >= 0:
        left = times[depth] - now
        stop = voltages[depth] - fallen
        variance = noise2 * left
        if depth < DEEPEST and needs_cut(x, stop, above, below, variance):
            state, gauss = normal(state)
            depth += 1
            times[depth] = now + 0.5 * left
            voltages[depth] = 0.5 * (x + stop) + 0.5 * math.sqrt(variance) * gauss + fallen
            continue
        state, side, time = exit_of_bridge(state, x, stop, left, variance, above, below)
        if side == 0:
            now, x = times[depth], stop
            depth -= 1
            continue
        if written == keys.shape[0]:
            return state, -1, 0.0, now
        now = min(now + time, times[depth])
        keys[written] = event_key(offset + now, address, side)
        written += 1
        path = fallen + (above if side > 0 else -below)  # where the path would be without resets
        if period > 0.0:
            state, depth, now, path = wait(state, depth, now, path, period, noise2, cuts)
        x = 0.0
        if reset_sigma > 0.0:
            state, gauss = normal(state)
            x = min(max(reset_sigma * gauss, -0.9 * below), 0.9 * above)
        fallen = path - x
    return state, written, x, now


@kernel
def wait(state: Any, depth: Any, now: Any, path: Any, period: Any, noise2: Any, cuts: Any) -> Any:
    """Let the path go on through the dead time. Returns (state, depth, time, path) at its end."""
    times, voltages = cuts[0], cuts[1]
    resume = now + period
    while depth >= 0 and times[depth] <= resume:
        now, path = times[depth], voltages[depth]
        depth -= 1
    if depth >= 0:
        left = times[depth] - now
        share = (resume - now) / left
        state, gauss = normal(state)
        path += share * (voltages[depth] - path) + math.sqrt(noise2 * left * share * (1.0 - share)) * gauss
    return state, depth, resume, path
