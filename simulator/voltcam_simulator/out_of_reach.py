"""Pixels whose thresholds are out of reach cannot fire, so nothing is drawn for them.

While both thresholds are more than `REACH` pending standard deviations away, drift adds to a mean and noise
to a pending variance. The pixels near a threshold are left to `crossings`.
"""

from typing import Any

import numpy as np

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
    voltage: Any, pending: Any, held: Any, above: Any, below: Any, drift: Any, noise: Any, span_us: Any,
    width: Any, ahead: Any, near: Any,
) -> Any:  # fmt: skip
    """Let drift and noise gather where no threshold is within reach, but not in rows that are drawn ahead.

    Called as accumulate(*pixels, *motion, span_us, width, ahead, near), see `groups`. ahead (rows,) bool.
    near (n + 1,) int32 receives the indices of the other pixels, which stay as they were. Returns their
    number.
    """
    span, row, count = np.float32(span_us), 0, 0
    while row < ahead.shape[0]:
        first = row
        while row < ahead.shape[0] and not ahead[row]:
            row += 1
        run = slice(first * width, row * width)
        several = Pixels(voltage[run], pending[run], held[run], above[run], below[run])
        count += _accumulate(several, drift[run], noise[run], span, near[count:], run.start)
        row += 1
    return count


@kernel
def _accumulate(pixels: Any, drift: Any, noise: Any, span: Any, near: Any, first: Any) -> Any:
    """Two loops, because the first is then vectorised."""
    voltage, pending, held = pixels.voltage, pixels.pending, pixels.held
    above, below = pixels.above, pixels.below
    reach2 = np.float32(REACH * REACH)
    far = np.empty(voltage.shape[0], np.bool_)
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
