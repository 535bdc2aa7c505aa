"""The wall clock that frames are stamped with."""

import threading
import time


class Clock:
    """Epoch microseconds, advanced by CLOCK_MONOTONIC: they agree with the wall clock when made and never
    step back afterwards, whatever NTP or a user does to the system's clock."""

    def __init__(self) -> None:
        self._epoch_minus_monotonic_us = (time.time_ns() - time.monotonic_ns()) // 1000

    def now_us(self) -> int:
        return self.epoch_us(time.monotonic_ns() // 1000)

    def epoch_us(self, monotonic_us: int) -> int:
        """CLOCK_MONOTONIC microseconds, as V4L2 stamps its buffers, as epoch microseconds."""
        return monotonic_us + self._epoch_minus_monotonic_us

    def wait_until(self, t_us: int, stop: threading.Event) -> bool:
        """Sleeps until `t_us` (at once when it is past); False when `stop` was set before."""
        return not stop.wait(max(0, t_us - self.now_us()) / 1e6)
