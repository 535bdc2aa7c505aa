"""What waits between the capture thread and the simulation thread: a few frames."""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

from voltcam_video import Fit, Frame, Outcome


@dataclass(frozen=True, slots=True, eq=False)
class Arrival:
    """A frame that came from the source.

    at_s: when, `time.monotonic()`. cut: the scene did not evolve continuously from the former frame.
    missed: frames dropped since the one before; at first, those that the source dropped.
    paced: it came when it was due; otherwise the source is read as fast as the simulation goes.
    """

    frame: Frame
    fit: Fit
    at_s: float
    cut: bool
    paced: bool
    missed: int = 0

    @property
    def patient(self) -> bool:
        """Whether it waits where there is no room, and is never dropped: so do recorded events, and frames
        whose sender waits."""
        if self.frame.sent is not None:
            return self.frame.sent.wait
        return not self.paced or self.frame.events is not None


SLOTS = 2  # at least: frames in a row make an interval
SPARE_SLOTS = 6  # where the machine can catch up: one that is late for once drops none


class Mailbox:
    """The newest few frames: the oldest of those that were not taken is dropped for a new one, and counted.

    can_catch_up: whether more than two may wait, as they will soon be taken.

    Who puts a patient frame waits instead until the former one is taken, and nothing is dropped.
    """

    def __init__(self, can_catch_up: Callable[[], bool] = lambda: False) -> None:
        self._can_catch_up = can_catch_up
        self.received = 0
        self.dropped = 0
        self._waiting: deque[Arrival] = deque()
        self._closed = False
        self._changed = threading.Condition()

    def put(self, arrival: Arrival, stop: threading.Event) -> None:
        """Leave a frame; does nothing once `stop` is set, which is followed by `wake`."""
        with self._changed:
            while arrival.patient and self._waiting and not stop.is_set() and not self._closed:
                self._changed.wait()
            if stop.is_set() or self._closed:
                return
            self._waiting.append(arrival)
            self.received += 1 + arrival.missed
            self.dropped += arrival.missed
            while len(self._waiting) > (SPARE_SLOTS if self._can_catch_up() else SLOTS):
                self.dropped += 1
                lost, following = self._waiting.popleft(), self._waiting[0]
                if lost.frame.sent is not None:
                    lost.frame.sent.tell(Outcome("dropped", "a newer one came"))
                # A cut stays one when the frame that brought it is dropped.
                cut, missed = following.cut or lost.cut, following.missed + lost.missed + 1
                self._waiting[0] = replace(following, cut=cut, missed=missed)
            self._changed.notify_all()

    def take(self) -> Arrival | None:
        """The next frame, waited for; None when closed."""
        with self._changed:
            while not self._waiting and not self._closed:
                self._changed.wait()
            self._changed.notify_all()
            return None if self._closed else self._waiting.popleft()

    @property
    def waiting(self) -> int:
        """How many are there."""
        return len(self._waiting)

    def wake(self) -> None:
        """Let those who wait look at their `stop` again."""
        with self._changed:
            self._changed.notify_all()

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()
