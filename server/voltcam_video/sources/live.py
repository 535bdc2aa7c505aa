"""What a camera and a stream have in common: a capture that may fail and come back."""

import threading
from abc import abstractmethod

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, luminance
from voltcam_video.opencv import CvCapture
from voltcam_video.request import SourceRequest
from voltcam_video.sources.source import Source, SourceError

DAMAGED_LIMIT = 30


class LiveSource(Source):
    """Frames of an opened capture, strictly increasing in time."""

    live = True
    endless = True
    coded = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._capture = self._open()
        self._last_us = 0

    @abstractmethod
    def _open(self) -> CvCapture:
        """The capture, opened. Raises SourceError."""

    @abstractmethod
    def _time_us(self) -> int:
        """When the frame just grabbed was taken, epoch microseconds."""

    @abstractmethod
    def _lost(self) -> str:
        """Why no frame could be grabbed, in one line."""

    def read(self) -> Frame:
        """The next frame. Raises SourceError when the camera or stream stalls, ends or goes away."""
        for _ in range(DAMAGED_LIMIT):
            if not self._capture.grab():
                raise SourceError(self._lost())
            t_us = max(self._time_us(), self._last_us + 1)
            ok, image = self._capture.retrieve()
            if ok:
                self._last_us = t_us
                return Frame(luminance(image), t_us, gamma=self.gamma)
        raise SourceError(f"{self.request.shown}: {DAMAGED_LIMIT} damaged frames in a row; check the link")

    def close(self) -> None:
        self._capture.release()
