"""A recording on the daemon's side: events and frames from now on, in one file or several, with manifests."""

import threading
import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from voltcam_client.formats import RecordingError, check_writable, left_out, suffix_of

from .interval import Interval, SimulationSetup, Start
from .log import log
from .problems import one_line
from .recording_file import RecordingFile
from .simulation import Simulation

QUEUE_BYTES = 256 * 2**20
DISK_S = 1.0  # how often the space that is left is looked at


@dataclass(frozen=True)
class RecordingPlan:
    """What is to be recorded. path: of the first file; the next ones are NAME-002.npz and so on.

    rotate_bytes, rotate_s: a file that has so much is ended, and the next begun; none: there is one file.
    least_free_bytes: the recording ends before the disk has less.
    """

    path: Path
    rotate_bytes: int | None = None
    rotate_s: float | None = None
    least_free_bytes: int = 0


class RecordingStatus(BaseModel):
    """A recording, with all its files."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    path: str
    """of the newest file"""

    recording: bool
    """whether it runs"""

    ending: bool
    """whether it was told to end, and what waits for the disk is still being written"""

    files: int
    """so far"""

    events: int
    """written, in all files"""

    frames: int
    """written, in all files"""

    lost_intervals: int
    """that came while the disk was too slow; each file is without gaps"""

    left_out: str
    """what its format cannot carry, in a line; empty where it carries all"""

    error: str | None
    """why it ended before it was told to; what was written until then is kept"""


class Recorder:
    """Writes in a thread of its own, beside the stream: nobody ever waits for the disk.

    What waits is bounded: where the disk is too slow for too long, the file ends, intervals are lost and
    counted until the queue is empty, and the next file begins. Raises FormatError or RecordingError when the
    first file cannot be made.
    """

    def __init__(self, plan: RecordingPlan, setup: SimulationSetup) -> None:
        check_writable(plan.path, overwrite=False)
        self._plan, self._setup = plan, setup
        self._file = RecordingFile(plan.path, setup)
        if lost := left_out(plan.path):
            log.warning("%s: %s", plan.path, lost)
        self._ended: list[RecordingFile] = []
        self._queue: deque[tuple[Start | None, Interval]] = deque()
        self._bytes, self._lost = 0, 0
        self._start: Start | None = None
        self._gap = True  # before what comes next: it needs a file that begins with it
        self._full, self._closing = False, False  # full: the next file should begin soon
        self._looked_s = 0.0
        self._error: str | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="voltcam-recorder", daemon=True)
        self._thread.start()

    def look(self, simulation: Simulation, source: str) -> None:
        """Called before each interval is made: keep the state where a file is to begin with it."""
        wanted = self._full or (self._gap and not self._queue)
        if wanted and self._start is None:
            self._start = simulation.start_of(source)

    def put(self, interval: Interval) -> None:
        """Leave an interval; never waits."""
        size = _size(interval)
        with self._changed:
            if self._closing or self._error is not None:
                return
            start, self._start = self._start, None
            waits_for_room = self._gap and (start is None or len(self._queue) > 0)
            if waits_for_room or self._bytes + size > QUEUE_BYTES:
                self._lost += 1
                self._gap = True
                return
            if start is not None:
                self._gap = self._full = False
            self._queue.append((start, interval))
            self._bytes += size
            self._changed.notify_all()

    def close(self, limit_s: float | None = None) -> None:
        """Write what waits, and finish the files. What takes longer than `limit_s` is left to its thread: the
        file can be read as it is then, as after a crash."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(limit_s)

    @property
    def waiting(self) -> int:
        """How many intervals are still to be written."""
        return len(self._queue)

    @property
    def busy(self) -> bool:
        """Whether its thread goes on."""
        return self._thread.is_alive()

    @property
    def status(self) -> RecordingStatus:
        files = [*self._ended, self._file]
        return RecordingStatus(
            path=str(self._file.path),
            recording=self._error is None and self.busy and not self._closing,
            ending=self.busy and self._closing,
            files=len(files),
            events=sum(file.events for file in files),
            frames=sum(file.frames for file in files),
            lost_intervals=self._lost,
            left_out=left_out(self._plan.path),
            error=self._error,
        )

    def _run(self) -> None:
        while self._error is None and (item := self._next()) is not None:
            try:
                self._write(*item)
            except (OSError, ValueError) as error:
                self._error = one_line(error)
        why = self._error or "it was ended"
        for file in [*self._ended, self._file]:
            try:
                file.end(why)
                file.wait()
            except (OSError, RecordingError) as error:
                self._error = self._error or one_line(error)

    def _next(self) -> tuple[Start | None, Interval] | None:
        with self._changed:
            while not self._queue and not self._closing:
                self._changed.wait()
            if not self._queue:
                return None
            item = self._queue.popleft()
            self._bytes -= _size(item[1])
            return item

    def _write(self, start: Start | None, interval: Interval) -> None:
        """Raises RecordingError, ValueError or OSError."""
        if start is not None and self._file.begun:
            self._file.end("the next file goes on")
            self._ended.append(self._file)
            self._file = RecordingFile(self._path_of(len(self._ended) + 1), self._setup)
        self._file.write(start, interval)
        if self._is_full(self._file):
            self._full = True
        if time.monotonic() - self._looked_s > DISK_S:
            self._looked_s = time.monotonic()
            free_bytes = self._file.free_bytes
            if free_bytes < self._plan.least_free_bytes:
                least = self._plan.least_free_bytes / 1e6
                raise RecordingError(
                    f"{self._file.path}: ended with {max(0, free_bytes) / 1e6:.0f} MB left on the disk: "
                    f"least_free_bytes keeps {least:.0f} MB"
                )

    def _is_full(self, file: RecordingFile) -> bool:
        plan = self._plan
        large = plan.rotate_bytes is not None and file.size_bytes >= plan.rotate_bytes
        return large or (plan.rotate_s is not None and file.span_s >= plan.rotate_s)

    def _path_of(self, number: int) -> Path:
        path = self._plan.path
        suffix = path.name[-len(suffix_of(path)) :]
        return path.with_name(f"{path.name.removesuffix(suffix)}-{number:03}{suffix}")


def _size(interval: Interval) -> int:
    """Bytes that it keeps while it waits."""
    aps = sum(frame.image.nbytes for frame in interval.beside.frames)
    return interval.events.nbytes + interval.image.nbytes + aps
