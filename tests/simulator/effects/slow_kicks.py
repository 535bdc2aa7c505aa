"""Kicked pixels without noise, followed in steps of a microsecond: shares nothing with the kernels."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Path = Callable[[int], NDArray[np.float64]]
Fired = list[tuple[int, int, int, bool]]
"""(t [us], x, y, ON) each."""


def slow_kicks(
    path: Path, end_us: int, after: dict[bool, float], delay_us: int, targets: Sequence[tuple[int, int]],
    dead_us: int = 0,
) -> Fired:  # fmt: skip
    """path(t): (height, width) voltages of pixels if they never fired. after: the kick by polarity. What a
    kick sets off does not kick."""
    before = path(0)
    voltage, held = before.copy(), np.full(before.shape, -1)
    height, width = before.shape
    due: dict[int, list[tuple[int, int, float]]] = {}
    fired: Fired = []

    def fire(t: int, x: int, y: int, on: bool) -> None:
        fired.append((t, x, y, on))
        voltage[y, x] -= 1 if on else -1
        held[y, x] = t + dead_us

    for t in range(1, end_us + 1):
        now = path(t)
        voltage += np.where(held < t, now - before, 0)
        before = now
        for y, x in zip(*np.nonzero(np.abs(voltage) >= 1), strict=True):
            on = bool(voltage[y, x] > 0)
            fire(t, int(x), int(y), on)
            for dx, dy in targets:
                if after[on] and 0 <= x + dx < width and 0 <= y + dy < height:
                    due.setdefault(t + delay_us, []).append((int(x) + dx, int(y) + dy, after[on]))
        for x, y, size in due.pop(t, []):
            if held[y, x] >= t:
                continue
            voltage[y, x] += size
            if abs(voltage[y, x]) >= 1:
                fire(t, x, y, bool(voltage[y, x] > 0))
                voltage[y, x] = 0
    return fired
