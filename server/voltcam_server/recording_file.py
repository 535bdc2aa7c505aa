"""One file of a recording, with its manifest."""

import os
import threading
from pathlib import Path

from voltcam_client.formats import RecordingError, open_writer
from voltcam_client.formats.spool import PARTIAL

from .interval import Interval, SimulationSetup, Start
from .manifest import ManifestWriter


class RecordingFile:
    """A file of a recording, without gaps. Raises FormatError or RecordingError when it cannot be made."""

    def __init__(self, path: Path, setup: SimulationSetup) -> None:
        self.path = path
        self.frames = 0
        self.size_bytes = 0
        self._setup = setup
        self._writer = open_writer(path, width=setup.camera.width, height=setup.camera.height)
        self._manifest: ManifestWriter | None = None
        self._first_us, self._last_us = 0, 0
        self._error: RecordingError | None = None
        self._finishing: threading.Thread | None = None

    @property
    def begun(self) -> bool:
        """Whether there is anything in it."""
        return self._manifest is not None

    @property
    def events(self) -> int:
        """How many are written, and safe."""
        return self._writer.event_count

    @property
    def span_s(self) -> float:
        """From its first frame to its last."""
        return (self._last_us - self._first_us) / 1e6

    @property
    def free_bytes(self) -> int:
        """What is left on the disk once it is finished: an .npz takes as much again then."""
        disk = os.statvfs(self.path.parent)
        again = self.size_bytes if self.path.with_name(self.path.name + PARTIAL).exists() else 0
        return disk.f_bavail * disk.f_frsize - again

    def write(self, start: Start | None, interval: Interval) -> None:
        """start: with the first. Raises RecordingError, ValueError or OSError."""
        if self._manifest is None:
            assert start is not None
            self._manifest = ManifestWriter(self.path, self._setup, start)
            self._first_us = interval.frame_us
        self._writer.events(interval.events)
        frames = self._write_frames(interval) if self._writer.holds_frames else 0
        self._writer.imu(interval.beside.imu)
        self._writer.triggers(interval.beside.triggers)
        self._manifest.interval(interval)
        self.frames += frames
        self._last_us = interval.frame_us
        self.size_bytes += interval.events.nbytes + frames * interval.image.size

    def _write_frames(self, interval: Interval) -> int:
        """How many."""
        if self._setup.frames == "source":
            self._writer.frame(interval.image_u8, interval.frame_us)
            return 1
        for image, exposure_us, frame_us in interval.beside.frames:
            self._writer.aps_frame(image, exposure_us, frame_us)
        return len(interval.beside.frames)

    def end(self, why: str) -> None:
        """Finish it, in a thread of its own: to put an .npz together takes a while. Again does no harm."""
        if self._finishing is None:
            finish = threading.Thread(target=self._finish, args=(why,), name="voltcam-finish", daemon=True)
            finish.start()
            self._finishing = finish

    def wait(self) -> None:
        """Until it is finished. Raises RecordingError when it could not be."""
        if self._finishing is not None:
            self._finishing.join()
        if self._error is not None:
            raise self._error

    def _finish(self, why: str) -> None:
        try:
            if self._manifest is not None:
                self._manifest.close(self.events, why)
            self._writer.close()
        except RecordingError as error:
            self._error = error
        except OSError as error:
            self._error = RecordingError(f"{self.path}: {error.strerror}: its manifest has no end")
