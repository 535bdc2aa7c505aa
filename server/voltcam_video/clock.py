"""The wall clock that frames are stamped with, and where the times of recordings lie on it."""

import threading
import time
from weakref import WeakValueDictionary

SET_US = 1000  # the wall clock is off by more only when somebody has set it


class TimeLine:
    """Where a recording's own time lies on the clock, for each turn of a loop: `shift_us` is to be added.

    Recordings that were made together share one: what has one recorded time is due at one moment.
    """

    def __init__(self, shared: bool = False) -> None:
        self.shared = shared
        self.turn = 0
        self._shifts_us: dict[int, int] = {}
        self._lock = threading.Lock()

    def begin(self, turn: int, shift_us: int) -> None:
        """Who comes first to a turn says where it lies; the others follow."""
        with self._lock:
            if turn not in self._shifts_us:
                self._shifts_us[turn] = shift_us
                self._shifts_us.pop(turn - 2, None)
                self.turn = turn

    def shift_us(self, turn: int) -> int:
        """Of a turn that has begun; of one long past, that of the newest."""
        with self._lock:
            return self._shifts_us.get(turn, self._shifts_us[self.turn])

    def move(self, turn: int, by_us: int) -> None:
        """All that is still to come is later."""
        with self._lock:
            if turn in self._shifts_us:
                self._shifts_us[turn] += by_us


class Clock:
    """Epoch microseconds, advanced by CLOCK_MONOTONIC: they agree with the wall clock when made, and do not
    follow what NTP or a user does to it until `renew`. Cameras that share one are on one clock."""

    def __init__(self) -> None:
        self._epoch_minus_monotonic_us = self._measured_us()
        self._lines: WeakValueDictionary[str, TimeLine] = WeakValueDictionary()
        self._lock = threading.Lock()

    @staticmethod
    def _measured_us() -> int:
        return (time.time_ns() - time.monotonic_ns()) // 1000

    def renew(self) -> None:
        """Agree with the wall clock again, where that has been set: for all who share this clock at once."""
        measured_us = self._measured_us()
        if abs(measured_us - self._epoch_minus_monotonic_us) > SET_US:
            self._epoch_minus_monotonic_us = measured_us

    def line(self, name: str | None) -> TimeLine:
        """The time line of recordings with this name, while one of them plays; without a name, one's own."""
        if name is None:
            return TimeLine()
        with self._lock:
            return self._lines.setdefault(name, TimeLine(shared=True))

    def now_us(self) -> int:
        return self.epoch_us(time.monotonic_ns() // 1000)

    def epoch_us(self, monotonic_us: int) -> int:
        """CLOCK_MONOTONIC microseconds, as V4L2 stamps its buffers, as epoch microseconds."""
        return monotonic_us + self._epoch_minus_monotonic_us

    def wait_until(self, t_us: int, stop: threading.Event) -> bool:
        """Sleeps until `t_us` (at once when it is past); False when `stop` was set before."""
        return not stop.wait(max(0, t_us - self.now_us()) / 1e6)
