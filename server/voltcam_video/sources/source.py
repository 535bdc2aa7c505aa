"""What every source is."""

import threading
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Literal, Self, TypedDict

import numpy as np

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, Image
from voltcam_video.light import gamma_of
from voltcam_video.request import SourceRequest


class SourceError(Exception):
    """One line that names the source, what is wrong and the remedy."""


class Granted(TypedDict):
    """What a source turned out to be; None is what it does not know.

    kind: of source, in a word. frames: as announced; containers without an index estimate it from their
    duration.
    clock: where the stamps come from. kernel: the driver's, of the moment of capture; arrival: when we got
    the frame; recording: the recording's own; sender: of the program that sends them.
    levels: what grey levels are taken for, see `SourceRequest`.
    """

    kind: str
    live: bool
    width: int
    height: int
    fps: float | None
    pixel_format: str | None
    frames: int | None
    backend: str | None
    clock: Literal["kernel", "arrival", "recording", "sender"]
    levels: Literal["light", "video"]


class Source(ABC):
    """Frames one after the other; a context manager and an iterator.

    live: comes from outside and may come back after an error, as a camera or stream does; reads never end,
    they raise SourceError. A recording ends with None. endless: does not end by itself, as live ones and the
    scene. expects: it is open before there is a frame, and waits for as long as it takes. coded: its grey
    levels are coded for screens.
    """

    live: bool
    endless: bool = False
    expects: bool = False
    coded: bool = False
    granted: Granted

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        """Whether the request's uri names a source of this kind. None does where it is not in SOURCES."""
        return False

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        """Opens it. `stop` ends a wait for the next frame's due time."""
        self.request = request
        self.clock = clock
        self.stop = stop

    @property
    def gamma(self) -> float:
        """Exponent from its grey levels to light."""
        return gamma_of(self.request.levels, self.coded)

    @property
    def levels(self) -> Literal["light", "video"]:
        """What its grey levels are taken for."""
        return "light" if self.gamma == 1 else "video"

    def _awaiting(self, kind: str, backend: str) -> Granted:
        """Of one that programs send to: what is not known here, their first frame tells."""
        return Granted(
            kind=kind,
            live=True,
            width=0,
            height=0,
            fps=None,
            pixel_format=None,
            frames=None,
            backend=backend,
            clock="sender",
            levels=self.levels,
        )

    def _look_at(self, image: Image) -> None:
        """Of programs that send images of several kinds: those of 8 bits are coded, finer ones are light."""
        self.coded = image.dtype == np.uint8
        self.granted["levels"] = self.levels

    @abstractmethod
    def read(self) -> Frame | None:
        """The next frame, None at the end. Raises SourceError."""

    @abstractmethod
    def close(self) -> None:
        """Gives the device, file or connection back; again does no harm."""

    def __iter__(self) -> Iterator[Frame]:
        while (frame := self.read()) is not None:
            yield frame

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
