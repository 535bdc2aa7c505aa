"""A video file, with its own time stamps."""

import logging
import threading
from collections.abc import Iterator
from pathlib import Path

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, luminance
from voltcam_video.opencv import CvCapture, cv2, fourcc_text
from voltcam_video.request import SourceRequest
from voltcam_video.sources.container import missing_bytes
from voltcam_video.sources.recorded import DEFAULT_PERIOD_US, RecordedSource
from voltcam_video.sources.source import Granted, SourceError

log = logging.getLogger(__name__)

SHORT = 0.95  # fewer frames than this part of those announced is worth a word


class FileSource(RecordedSource):
    """Frames in the order shown, at the file's presentation times (variable rates included), from its start.

    A file cut short gives all frames it has and then raises SourceError instead of ending.
    """

    coded = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        super().__init__(request, clock, stop)
        self._path = Path(request.uri)
        capture = self._open()
        fps = capture.get(cv2.CAP_PROP_FPS)
        self._announced = max(0, int(capture.get(cv2.CAP_PROP_FRAME_COUNT)))
        self._period_us = round(1e6 / fps) if fps > 0 else DEFAULT_PERIOD_US
        self.granted = Granted(
            kind="file",
            live=False,
            width=int(capture.get(cv2.CAP_PROP_FRAME_WIDTH)),
            height=int(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)),
            fps=fps if fps > 0 else None,
            pixel_format=fourcc_text(capture),
            frames=self._announced or None,
            backend=capture.getBackendName(),
            clock="recording",
            levels=self.levels,
        )
        capture.release()

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.path is not None

    def _open(self) -> CvCapture:
        try:
            empty, missing = not self._path.stat().st_size, missing_bytes(self._path)
        except FileNotFoundError:
            raise SourceError(
                f"{self._path}: no such file; a source is scene, a camera (0, /dev/video0), a video file, "
                "a folder with images.txt, an .npz, or a URL"
            ) from None
        except OSError as error:
            raise SourceError(f"{self._path}: cannot be read: {error.strerror}") from None
        capture = cv2.VideoCapture(str(self._path), cv2.CAP_FFMPEG)
        if capture.isOpened():
            return capture
        if empty:
            raise SourceError(f"{self._path}: the file is empty; record or copy it again")
        if missing:
            raise SourceError(f"{self._path}: cut short, {missing} bytes are missing; copy it again, whole")
        raise SourceError(
            f"{self._path}: not a video ffmpeg can read, or never finished by its recorder; "
            f"ffprobe {self._path} says more"
        )

    def _take(self) -> Iterator[Frame]:
        capture = self._open()
        try:
            count = 0
            t_us: int | None = None
            while capture.grab():
                t_us = self._time_us(capture, count, t_us)
                ok, image = capture.retrieve()
                if ok:
                    yield Frame(luminance(image), t_us, gamma=self.gamma)
                    count += 1
        finally:
            capture.release()
        self._check_end(count, t_us or 0)

    def _time_us(self, capture: CvCapture, index: int, former_us: int | None) -> int:
        # After grab() it is that frame's presentation time; 0 where it has none: raw streams, and the frames
        # that come out of the decoder after the end of an AVI.
        t_us = round(capture.get(cv2.CAP_PROP_POS_MSEC) * 1000)
        if former_us is None or t_us > former_us:
            return t_us
        if t_us == 0:
            return former_us + self._period_us
        raise SourceError(
            f"{self._path}: frame {index} is at {t_us} us, not later than the one before ({former_us} us); "
            f"ffmpeg -i {self._path} -vf setpts=N/FRAME_RATE/TB repaired.mp4 gives it even times"
        )

    def _check_end(self, count: int, last_us: int) -> None:
        missing = missing_bytes(self._path)
        if missing or not count:
            raise SourceError(
                f"{self._path}: ended early, {count} frames read of {self._announced} announced"
                + (f", {missing} bytes missing" if missing else "")
                + "; copy or record it again"
            )
        short_in_time = last_us + self._period_us < SHORT * self._announced * self._period_us
        if count < SHORT * self._announced and short_in_time:
            log.warning("%s: %d frames read of %d announced", self._path, count, self._announced)
