"""Writing a recording so that what was written is never lost: whole records, nothing held back."""

import contextlib
import errno
import os
from abc import ABC, abstractmethod
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats.recording import MAX_T_US, RecordingError, fault_in
from voltcam_client.samples import ImuSamples, Triggers

# Events per write: the most that a full disk can cost of one call.
CHUNK = 1 << 16

_START_BITS = 23


def start_us(t_us: int) -> int:
    """Where a file that counts its times from its beginning begins, for a first event at `t_us`.

    The last multiple of 2^23 us (8.4 s) before it: what a source that begins at 0 gives keeps its times for
    every reader, and what is of this day begins near 0.
    """
    return t_us >> _START_BITS << _START_BITS


def cannot_create(path: Path, error: OSError) -> RecordingError:
    """The one line for a target that cannot be made."""
    if error.errno == errno.EEXIST:
        return exists_already(path)
    return RecordingError(f"{path} cannot be created: {error.strerror}: choose a folder that can be written")


def exists_already(path: Path) -> RecordingError:
    """The one line for a target that is there."""
    return RecordingError(
        f"{path} exists already: choose another name, or remove it (convert and record: --overwrite)"
    )


class AppendFile:
    """A file that only grows, by whole records.

    An append is with the operating system when it returns, so that a killed process loses none of it; a
    failed one is taken back.
    """

    def __init__(self, path: Path, *, overwrite: bool) -> None:
        existing = os.O_TRUNC if overwrite else os.O_EXCL
        self._fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | existing, 0o666)
        self._size = 0

    @classmethod
    def continued(cls, path: Path) -> Self:
        """A file that may be there already, and then goes on from its end."""
        path.touch()
        file = cls.__new__(cls)
        file._fd, file._size = os.open(path, os.O_WRONLY | os.O_APPEND), path.stat().st_size
        return file

    def append(self, data: bytes | bytearray) -> None:
        """Write all of `data`, or raise OSError with the file as it was."""
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[os.write(self._fd, rest) :]
        except BaseException:  # an interrupt, too, must not leave half a record behind
            with contextlib.suppress(OSError):
                os.ftruncate(self._fd, self._size)
            raise
        self._size += len(data)

    def close(self) -> None:
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


class Writer(ABC):
    """Appends events, and frames where `holds_frames`, to a recording; a context manager.

    What `events` and `frame` have written can be read back whatever happens to this process afterwards.
    """

    holds_frames: ClassVar[bool] = False
    holds_samples: ClassVar[bool] = False  # of an IMU, and triggers
    holds_time_of_day: ClassVar[bool] = True  # else times count from the file's beginning, and none says it
    longest_silence_us: ClassVar[int] = MAX_T_US
    longest_span_us: ClassVar[int] = MAX_T_US  # from the file's first event

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool = False) -> None:
        self.path = path
        self.width = width
        self.height = height
        self.event_count = 0  # written, and safe
        self._overwrite = overwrite
        self._first_t_us = 0
        self._last_t_us = 0
        self._closed = False
        self._failure: RecordingError | None = None

    def events(self, events: Events) -> None:
        """Append an EVENT array, sorted by t and not before the events already there.

        Raises ValueError, with nothing written, for events that do not fit; RecordingError when the disk
        takes no more, and `event_count` then says how many are safe.
        """
        if events.dtype != EVENT or events.ndim != 1:
            raise ValueError(
                f"events must be a one-dimensional EVENT array, not {events.dtype}{events.shape}"
            )
        last_t_us = self._last_t_us if self.event_count else None
        fault = fault_in(events, self.width, self.height, last_t_us, self.longest_silence_us)
        if fault:
            raise ValueError(f"{self.path}: {fault}")
        self._check_span(events)
        for start in range(0, events.size, CHUNK):
            chunk = events[start : start + CHUNK]
            with self._writing():
                self._append(chunk)
            self._first_t_us = self._first_t_us if self.event_count else int(chunk["t"][0])
            self.event_count += chunk.size
            self._last_t_us = int(chunk["t"][-1])

    def _check_span(self, events: Events) -> None:
        """Raises ValueError for events that come too late for the format to say when."""
        first_us = self._first_t_us if self.event_count or not events.size else int(events["t"][0])
        if events.size and events["t"][-1] - start_us(first_us) >= self.longest_span_us:
            raise ValueError(
                f"{self.path}: it counts {self.longest_span_us / 3.6e9:.3g} hours from its beginning: "
                "record on into another file"
            )

    @abstractmethod
    def frame(self, image: NDArray[np.uint8], t_us: int) -> None:
        """Append a (height, width) uint8 image taken at `t_us`; left out by a format that holds no frames."""

    def aps_frame(
        self,
        image: NDArray[np.uint8],
        exposure_us: tuple[int, int],
        frame_us: tuple[int, int] | None = None,
    ) -> None:
        """Append a frame with the (begin, end) of its exposure, and of the readout around it; a format that
        keeps one time only has the middle of the exposure."""
        self.frame(image, sum(exposure_us) // 2)

    def imu(self, samples: ImuSamples) -> None:  # noqa: B027
        """Append IMU samples; left out by a format that holds none."""

    def triggers(self, triggers: Triggers) -> None:  # noqa: B027
        """Append TRIGGER rows; left out by a format that holds none."""

    def close(self) -> None:
        """Finish the recording. After a failed write this leaves what is safe as it is."""
        self._closed = True

    @abstractmethod
    def _append(self, events: Events) -> None:
        """Write up to CHUNK events, all or none of them; OSError as it comes."""

    def _check_image(self, image: NDArray[np.uint8]) -> None:
        """Raises ValueError for a frame that is none of this camera."""
        if image.shape != (self.height, self.width) or image.dtype != np.uint8:
            raise ValueError(
                f"a frame must be uint8 {(self.height, self.width)}, not {image.dtype} {image.shape}"
            )

    def _rescue(self) -> str:
        """Where the events written so far are, and how to get at them."""
        return f"{self.path}: make room and record on into another file"

    def _failed(self, error: OSError) -> RecordingError:
        return RecordingError(
            f"{self.path}: {error.strerror}: {self.event_count} events are safe in {self._rescue()}"
        )

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """Turns an OSError into the RecordingError that this writer gives from then on."""
        if self._failure:
            raise self._failure
        if self._closed:
            raise ValueError(f"{self.path} is closed: open another recording")
        try:
            yield
        except OSError as error:
            self._failure = self._failed(error)
            raise self._failure from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class AppendWriter(Writer):
    """Events in one file, complete after every append; a format gives its header and its encoding."""

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool = False) -> None:
        super().__init__(path, width, height, overwrite=overwrite)
        try:
            self._file = AppendFile(path, overwrite=overwrite)
            self._file.append(self._header())
        except OSError as error:
            raise cannot_create(path, error) from error

    def frame(self, image: NDArray[np.uint8], t_us: int) -> None:
        """Left out."""

    def close(self) -> None:
        super().close()
        self._file.close()

    def _append(self, events: Events) -> None:
        self._file.append(self._encode(events))

    def _header(self) -> bytes:
        return b""

    @abstractmethod
    def _encode(self, events: Events) -> bytes:
        """The bytes that say these events, after all those before them."""
