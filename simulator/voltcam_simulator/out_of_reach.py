"""Pixels whose thresholds are out of reach cannot fire, so nothing is drawn for them.

While both thresholds are more than `REACH` pending standard deviations away, drift adds to a mean and noise
to a pending variance. The pixels near a threshold are left to `crossings`.
"""

from typing import Any

import numpy as np

from .bends import straightness
from .groups import Pixels
from .kernel import kernel

REACH = 7.4
"""Standard deviations beyond which a threshold is out of reach: 4 Q(7.4) < 3e-13."""


@kernel
def add_response(light: Any, response: Any, drift: Any, last_light: Any, last_response: Any) -> None:
    """Add the change of response to the drift; the new light and response become the last. (n,)."""
    for i in range(drift.shape[0]):
        drift[i] += response[i] - last_response[i]
        last_response[i] = response[i]
        last_light[i] = light[i]


@kernel
def accumulate(
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, drift: Any, noise: Any, bow: Any,
    span_us: Any, width: Any, ahead: Any, near: Any, bent: Any,
) -> Any:  # fmt: skip
    """Let drift and noise gather where no threshold is within reach, but not in rows that are drawn ahead.

    Called as accumulate(*pixels, *motion, bow, span_us, width, ahead, near, bent), see `groups`.
    ahead (rows,) bool. near and bent (n + 1,) int32 receive the numbers of the other pixels, which stay as
    they were: those whose mean path is straight, and those where it is not. Returns how many each are.
    """
    span, row, straight, curved = np.float32(span_us), 0, 0, 0
    far, level = np.empty(voltage.shape[0], np.bool_), np.empty(voltage.shape[0], np.bool_)
    while row < ahead.shape[0]:
        first = row
        while row < ahead.shape[0] and not ahead[row]:
            row += 1
        run = slice(first * width, row * width)
        several = Pixels(voltage[run], pending[run], held[run], above[run], below[run])
        rest = near[straight:]
        if bow is None:
            straight += _accumulate(several, drift[run], noise[run], span, far, rest, run.start)
        else:
            more, others = accumulate_bent(
                several, drift[run], noise[run], bow[run], span, far, level, rest, bent[curved:], run.start
            )
            straight, curved = straight + more, curved + others
        row += 1
    return straight, curved


@kernel
def _accumulate(pixels: Any, drift: Any, noise: Any, span: Any, far: Any, near: Any, first: Any) -> Any:
    """Two loops, because the first is then vectorised; far (n or more,) bool is worked on."""
    voltage, pending, held = pixels.voltage, pixels.pending, pixels.held
    above, below = pixels.above, pixels.below
    reach2 = np.float32(REACH * REACH)
    for i in range(voltage.shape[0]):
        start = voltage[i]
        end = start + drift[i]
        variance = pending[i] + noise[i] * noise[i] * span
        closest = min(above[i] - max(start, end), below[i] + min(start, end))
        far[i] = (closest > 0) & (closest * closest > reach2 * variance) & (held[i] <= 0)
        voltage[i] = end if far[i] else start
        pending[i] = variance if far[i] else pending[i]
    count = 0
    for i in range(voltage.shape[0]):
        near[count] = first + i
        count += not far[i]
    return count


@kernel
def accumulate_bent(
    pixels: Any, drift: Any, noise: Any, bow: Any, span: Any, far: Any, straight: Any, near: Any, bent: Any,
    first: Any,
) -> Any:  # fmt: skip
    """The same where mean paths may be bent: such a path goes no further beyond its ends than its bow."""
    voltage, pending, held = pixels.voltage, pixels.pending, pixels.held
    above, below = pixels.above, pixels.below
    reach2, nothing = np.float32(REACH * REACH), np.float32(0)
    tolerance, share = straightness(span)
    for i in range(voltage.shape[0]):
        start, aside = voltage[i], bow[i]
        end = start + drift[i]
        variance = pending[i] + noise[i] * noise[i] * span
        highest, lowest = max(start, end) + max(aside, nothing), min(start, end) + min(aside, nothing)
        closest = min(above[i] - highest, below[i] + lowest)
        far[i] = (closest > 0) & (closest * closest > reach2 * variance) & (held[i] <= 0)
        straight[i] = abs(aside) <= max(tolerance, share * abs(drift[i]))
        voltage[i] = end if far[i] else start
        pending[i] = variance if far[i] else pending[i]
    count, curved = 0, 0
    for i in range(voltage.shape[0]):
        near[count] = first + i
        bent[curved] = first + i
        count += straight[i] & (not far[i])
        curved += not (straight[i] | far[i])
    return count, curved
