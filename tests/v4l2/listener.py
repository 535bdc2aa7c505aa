"""A subscriber that stays, in a thread: what came, and whether its order held."""

import threading
from contextlib import suppress

import numpy as np

from voltcam_client import EventCamera

POLL_S = 0.5


class Listener:
    """Subscribed once, for the whole test: a context manager. Counts are since the start.

    gap_us: the longest time without events, from the last before to the first after; it may be set back.
    """

    def __init__(self, endpoint: str) -> None:
        self.packets = self.events = self.backwards = 0
        self.last_us = 0
        self.gap_us = (0, 0)
        self.lost_packets = self.restarts = 0
        self.error: str | None = None
        self._endpoint, self._done = endpoint, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        try:
            with EventCamera(self._endpoint) as camera:
                while not self._done.is_set():
                    with suppress(TimeoutError):
                        if (packet := camera.receive(POLL_S)) is not None:
                            self._take(packet.events)
                    self.lost_packets, self.restarts = camera.lost_packets, camera.restarts
        except Exception as error:
            self.error = repr(error)

    def _take(self, events: np.ndarray) -> None:
        self.packets += 1
        if events.size:
            times_us = events["t"].astype(np.int64)
            self.backwards += int(times_us[0] < self.last_us) + int((np.diff(times_us) < 0).sum())
            gap_us = (self.last_us, int(times_us[0]))
            if self.last_us and gap_us[1] - gap_us[0] > self.gap_us[1] - self.gap_us[0]:
                self.gap_us = gap_us
            self.last_us = int(times_us[-1])
            self.events += events.size

    def __enter__(self) -> "Listener":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join(10)
