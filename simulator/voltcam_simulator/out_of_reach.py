"""Lazy noise: pixels whose barriers are far away cannot fire, so nothing is drawn for them.

While both barriers are more than `REACH` pending standard deviations away drift adds to a mean and noise to a
pending variance. The pixels near a barrier are left to `crossings`.
"""

from typing import Any

import numpy as np

from .kernel import kernel

REACH = 7.4
"""Standard deviations beyond which a barrier is out of reach: 4 Q(7.4) < 3e-13."""


@kernel
def take_over(light: Any, response: Any, drift: Any, last_light: Any, last_response: Any) -> None:
    """Add the change of response to the drift; the new light and response become the last. (pixels,)."""
    for i in range(drift.shape[0]):
        drift[i] += response[i] - last_response[i]
        last_response[i] = response[i]
        last_light[i] = light[i]


@kernel
def gather(
    ahead: Any, voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any,
    held: Any, near: Any,
) -> Any:  # fmt: skip
    """Let drift and noise gather where no barrier is within reach, but not in rows that are drawn ahead.

    ahead (rows,) bool; the others (pixels,) float32; held: dead time left [us]. near (pixels + 1,) int32
    receives the indices of the other pixels, which stay as they were. Returns their number.
    """
    width, row, count = voltage.shape[0] // ahead.shape[0], 0, 0
    while row < ahead.shape[0]:
        first = row
        while row < ahead.shape[0] and not ahead[row]:
            row += 1
        run = slice(first * width, row * width)
        count += _gather(
            voltage[run], pending[run], drift[run], noise[run], span, above[run], below[run], held[run],
            near[count:], run.start,
        )  # fmt: skip
        row += 1
    return count


@kernel
def _gather(
    voltage: Any, pending: Any, drift: Any, noise: Any, span: Any, above: Any, below: Any, held: Any,
    near: Any, first: Any,
) -> Any:  # fmt: skip
    """Two loops, because the first is then vectorised."""
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
