"""A stream: rtsp://, http:// (MJPEG or any other), udp://, whatever ffmpeg opens."""

import os
import threading
import time

from voltcam_video.clock import Clock
from voltcam_video.opencv import CvCapture, cv2, fourcc_text
from voltcam_video.request import SourceRequest
from voltcam_video.sources.live import LiveSource
from voltcam_video.sources.source import Granted, SourceError

# Without these ffmpeg keeps what it read while probing the stream, and all frames come that much late.
LOW_LATENCY = "rtsp_flags;prefer_tcp|fflags;nobuffer|flags;low_delay"
OPTIONS = "OPENCV_FFMPEG_CAPTURE_OPTIONS"
_opening = threading.Lock()

BACKLOG_FRAMES = 250
WAITED_S = 0.004


class NetworkSource(LiveSource):
    """A stream, its frames stamped with their time of arrival.

    Not with the stream's own stamps: MJPEG has none (ffmpeg makes them up at 25 per second), and those of RTP
    and MPEG-TS run on the sender's clock, which drifts from ours and starts anew with the sender.
    """

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._drop_backlog()
        self._grabbed_s = time.monotonic()
        self.granted = Granted(
            kind="network",
            live=True,
            width=int(self._capture.get(cv2.CAP_PROP_FRAME_WIDTH)),
            height=int(self._capture.get(cv2.CAP_PROP_FRAME_HEIGHT)),
            fps=None,  # what ffmpeg says is a guess
            pixel_format=fourcc_text(self._capture),
            frames=None,
            backend=self._capture.getBackendName(),
            clock="arrival",
            levels=self.levels,
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return "://" in request.uri

    def _open(self) -> CvCapture:
        timeout_ms = round(self.request.timeout_s * 1000)
        timeouts = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, timeout_ms, cv2.CAP_PROP_READ_TIMEOUT_MSEC, timeout_ms]
        with _opening:
            given = os.environ.get(OPTIONS)
            os.environ[OPTIONS] = given or LOW_LATENCY
            try:
                capture = cv2.VideoCapture(self.request.uri, cv2.CAP_FFMPEG, timeouts)
            finally:
                if given is None:
                    del os.environ[OPTIONS]
        shown = self.request.shown
        if not capture.isOpened():
            raise SourceError(
                f"{shown}: no stream there within {self.request.timeout_s:g} s; check the address and that "
                f"the sender runs (ffprobe {shown} says more)"
            )
        if capture.get(cv2.CAP_PROP_FRAME_COUNT) > 0:
            capture.release()
            raise SourceError(f"{shown}: a file, not a stream; download it and give its path")
        return capture

    def _drop_backlog(self) -> None:
        """Frames that were buffered while opening come at once and are old: up to the first waited for."""
        for _ in range(BACKLOG_FRAMES):
            start_s = time.monotonic()
            if not self._capture.grab() or time.monotonic() - start_s > WAITED_S:
                return

    def _time_us(self) -> int:
        self._grabbed_s = time.monotonic()
        return self.clock.now_us()

    def _lost(self) -> str:
        if time.monotonic() - self._grabbed_s >= self.request.timeout_s:
            return f"{self.request.shown}: no frame for {self.request.timeout_s:g} s; the stream stalled"
        return f"{self.request.shown}: the stream ended; start the sender again"
