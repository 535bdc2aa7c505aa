"""A camera that Linux knows: V4L2, by index or device file."""

import errno
import math
import os
import stat
import threading
import time
from collections.abc import Callable
from pathlib import Path

from voltcam_video.clock import Clock
from voltcam_video.opencv import CvCapture, cv2, fourcc_text
from voltcam_video.request import SourceRequest
from voltcam_video.sources.live import LiveSource
from voltcam_video.sources.source import Granted, SourceError

STALE_US = 10_000_000
LET_GO_S, RETRY_S = 1.0, 0.1  # a camera just let go, by us too, is free when its last frame has come


def kernel_time_us(stamp_us: int, clock: Clock) -> int | None:
    """A V4L2 buffer's stamp as epoch microseconds; None when it is on no clock we know.

    Drivers stamp with CLOCK_MONOTONIC (V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) and a few, by option, with the wall
    clock. OpenCV does not pass the flag on, so the clock is told by which one makes the frame a recent one.
    """
    now_us = clock.now_us()
    for t_us in (clock.epoch_us(stamp_us), stamp_us):
        if 0 <= now_us - t_us < STALE_US:
            return t_us
    return None


class DeviceSource(LiveSource):
    """A camera. Width, height, fps and pixel format are asked for; `granted` says what the driver gave.

    Frames carry the kernel's time of capture, or else their time of arrival, which is a frame's transfer and
    decoding later.
    """

    def __init__(
        self,
        request: SourceRequest,
        clock: Clock,
        stop: threading.Event,
        open_capture: Callable[[str, int], CvCapture] = cv2.VideoCapture,
    ) -> None:
        self._path = request.device or request.uri
        self._open_capture = open_capture
        # OpenCV has no other way to set it, and listens to the first camera of a process only.
        os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", str(math.ceil(request.timeout_s)))
        super().__init__(request, clock, stop)
        self.granted = self._ask()

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.device is not None

    def _open(self) -> CvCapture:
        _check(self._path)
        deadline_s = time.monotonic() + LET_GO_S
        while True:
            capture = self._open_capture(self._path, cv2.CAP_V4L2)
            if capture.isOpened():
                return capture
            if time.monotonic() > deadline_s or self.stop.wait(RETRY_S):
                raise SourceError(
                    f"{self._path}: cannot capture: another program has it (fuser -v {self._path} names it), "
                    f"or it is no camera; {_cameras()}"
                )

    def _ask(self) -> Granted:
        capture, request = self._capture, self.request
        if request.pixel_format:
            capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*request.pixel_format))
        # OpenCV changes the size when it has both: one alone keeps the other.
        if request.width or request.height:
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, request.width or capture.get(cv2.CAP_PROP_FRAME_WIDTH))
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, request.height or capture.get(cv2.CAP_PROP_FRAME_HEIGHT))
        if request.fps:
            capture.set(cv2.CAP_PROP_FPS, request.fps)
        if not capture.grab():
            capture.release()
            raise SourceError(
                f"{self._path}: opened, but no frame came; close other programs that use it, or ask for a "
                "smaller size or pixel_format MJPG"
            )
        stamped = kernel_time_us(self._stamp_us(), self.clock) is not None
        return Granted(
            kind="device",
            live=True,
            width=int(capture.get(cv2.CAP_PROP_FRAME_WIDTH)),
            height=int(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)),
            fps=capture.get(cv2.CAP_PROP_FPS) or None,
            pixel_format=fourcc_text(capture),
            frames=None,
            backend=capture.getBackendName(),
            clock="kernel" if stamped else "arrival",
            levels=self.levels,
        )

    def _stamp_us(self) -> int:
        return round(self._capture.get(cv2.CAP_PROP_POS_MSEC) * 1000)

    def _time_us(self) -> int:
        t_us = kernel_time_us(self._stamp_us(), self.clock)
        return self.clock.now_us() if t_us is None else t_us

    def _lost(self) -> str:
        if _gone(self._path):
            return f"{self._path}: unplugged; plug it in again"
        return f"{self._path}: no frame came; the camera stalled or another program took it"


def _check(path: str) -> None:
    """Says why a device file cannot be opened, which OpenCV would not. Raises SourceError."""
    try:
        mode = Path(path).stat().st_mode
        if stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode):  # somebody's, behind /dev/fd
            raise SourceError(f"{path} is no camera; {_cameras()}")
        os.close(os.open(path, os.O_RDWR | os.O_NONBLOCK))
    except FileNotFoundError:
        raise SourceError(f"{path}: no such device; {_cameras()}") from None
    except PermissionError:
        raise SourceError(
            f"{path}: not permitted; sudo usermod -aG video $USER, then log in again; or, for a container, "
            "--group-add with the number of its group"
        ) from None
    except OSError as error:
        raise SourceError(f"{path}: {error.strerror}; fuser -v {path} names who has it") from None


def _gone(path: str) -> bool:
    """Whether there is no camera any more: its file may outlive it, for a moment or while we hold it."""
    try:
        os.close(os.open(path, os.O_RDWR | os.O_NONBLOCK))
    except OSError as error:
        return error.errno in (errno.ENOENT, errno.ENODEV, errno.ENXIO)
    return False


def _cameras() -> str:
    devices = sorted(Path("/dev").glob("video*"))
    if not devices:
        return "there is no /dev/video* here (a container needs it passed through: --device /dev/video0)"
    return "there are " + ", ".join(f"{device} ({_name(device)})" for device in devices)


def _name(device: Path) -> str:
    try:
        return Path("/sys/class/video4linux", device.name, "name").read_text().strip()
    except OSError:
        return "unnamed"
