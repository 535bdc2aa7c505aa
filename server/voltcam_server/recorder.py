"""A recording on the daemon's side: all events and frames from now on, into one file."""

import contextlib
import queue
import threading
from pathlib import Path

from pydantic import BaseModel

from voltcam_client.formats import RecordingError, open_writer

from .simulation import Interval

QUEUE_INTERVALS = 64


class RecordingStatus(BaseModel):
    """error: why it ended before it was told to; what was written until then is kept."""

    path: str
    recording: bool
    events: int
    frames: int
    error: str | None


class Recorder:
    """Writes in a thread of its own. A recording has no gaps: when the disk is slow, `put` waits, and the
    camera drops frames instead.

    Raises FormatError or RecordingError when the file cannot be made.
    """

    def __init__(self, path: str, width: int, height: int) -> None:
        self._writer = open_writer(Path(path), width=width, height=height)
        self._frames = 0
        self._error: str | None = None
        self._queue: queue.Queue[Interval | None] = queue.Queue(QUEUE_INTERVALS)
        self._thread = threading.Thread(target=self._run, name="voltcam-recorder", daemon=True)
        self._thread.start()

    def put(self, interval: Interval) -> None:
        self._queue.put(interval)

    def close(self, limit_s: float | None = None) -> None:
        """Write what waits, and finish the file. What takes longer than `limit_s` is left to its thread: the
        file can be read as it is then, as after a crash."""
        with contextlib.suppress(queue.Full):
            self._queue.put(None, timeout=limit_s)
        self._thread.join(limit_s)

    @property
    def waiting(self) -> int:
        """How many intervals are still to be written."""
        return self._queue.qsize()

    @property
    def busy(self) -> bool:
        """Whether its thread goes on."""
        return self._thread.is_alive()

    @property
    def status(self) -> RecordingStatus:
        return RecordingStatus(
            path=str(self._writer.path),
            recording=self._error is None and self._thread.is_alive(),
            events=self._writer.event_count,
            frames=self._frames,
            error=self._error,
        )

    def _run(self) -> None:
        while (interval := self._queue.get()) is not None:
            if self._error is None:
                self._write(interval)
        try:
            self._writer.close()
        except RecordingError as error:
            self._error = str(error)

    def _write(self, interval: Interval) -> None:
        try:
            self._writer.events(interval.events)
            self._writer.frame(interval.image_u8, interval.frame_us)
            self._frames += self._writer.holds_frames
        except (RecordingError, ValueError) as error:
            self._error = str(error)
