"""What waits between the capture thread and the simulation thread: at most one frame."""

import threading
from dataclasses import dataclass, replace

from voltcam_video import Fit, Frame


@dataclass(frozen=True, slots=True, eq=False)
class Arrival:
    """A frame that came from the source.

    at_s: when, `time.monotonic()`. cut: the scene did not evolve continuously from the former frame.
    missed: frames dropped since the one before.
    paced: it came when it was due; otherwise the source is read as fast as the simulation goes.
    """

    frame: Frame
    fit: Fit
    at_s: float
    cut: bool
    paced: bool
    missed: int = 0


class Mailbox:
    """One slot. The newest frame wins: who puts replaces what was not taken, which counts as dropped.

    Who puts a frame that is not paced waits instead until the slot is free, and nothing is dropped.
    """

    def __init__(self) -> None:
        self.received = 0
        self.dropped = 0
        self._slot: Arrival | None = None
        self._closed = False
        self._changed = threading.Condition()

    def put(self, arrival: Arrival, stop: threading.Event) -> None:
        """Leave a frame; does nothing once `stop` is set, which is followed by `wake`."""
        with self._changed:
            while not arrival.paced and self._slot is not None and not stop.is_set() and not self._closed:
                self._changed.wait()
            if stop.is_set() or self._closed:
                return
            if self._slot is not None:
                self.dropped += 1
                # A cut stays one when the frame that brought it is dropped.
                cut, missed = arrival.cut or self._slot.cut, self._slot.missed + 1
                arrival = replace(arrival, cut=cut, missed=missed)
            self._slot = arrival
            self.received += 1
            self._changed.notify_all()

    def take(self) -> Arrival | None:
        """The next frame, waited for; None when closed."""
        with self._changed:
            while self._slot is None and not self._closed:
                self._changed.wait()
            arrival, self._slot = self._slot, None
            self._changed.notify_all()
            return None if self._closed else arrival

    def wake(self) -> None:
        """Let those who wait look at their `stop` again."""
        with self._changed:
            self._changed.notify_all()

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()
