"""OpenCV, told to keep its own and ffmpeg's log lines off stderr: our errors say it in one line.

Both stay talkative for a user who sets OPENCV_LOG_LEVEL or OPENCV_FFMPEG_LOGLEVEL.
"""

import os
from typing import Any, Protocol

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # AV_LOG_QUIET; read when the first video opens

import cv2

if "OPENCV_LOG_LEVEL" not in os.environ:
    # OpenCV 4 has it here, OpenCV 5 there.
    silence = getattr(cv2, "setLogLevel", None) or cv2.utils.logging.setLogLevel
    silence(0)

__all__ = ["CvCapture", "backends", "cv2", "fourcc_text", "use_one_thread"]


class CvCapture(Protocol):
    """What we use of `cv2.VideoCapture`, so that a test can stand in for a camera."""

    def isOpened(self) -> bool: ...  # noqa: N802
    def get(self, prop: int, /) -> float: ...
    def set(self, prop: int, value: float, /) -> bool: ...
    def grab(self) -> bool: ...
    def retrieve(self) -> tuple[bool, Any]: ...
    def release(self) -> None: ...
    def getBackendName(self) -> str: ...  # noqa: N802


def use_one_thread() -> None:
    """From now on OpenCV works in the thread that asks it, and ffmpeg decodes in one: for a process of which
    there are as many as cores."""
    cv2.setNumThreads(0)
    os.environ["OPENCV_FFMPEG_THREADS"] = "1"


def backends() -> list[str]:
    """What reads videos and cameras here, by OpenCV's names."""
    registry = cv2.videoio_registry
    known = {*registry.getStreamBackends(), *registry.getCameraBackends()}
    return sorted(registry.getBackendName(each) for each in known if registry.hasBackend(each))


def fourcc_text(capture: CvCapture) -> str | None:
    """The four characters of the pixel format or codec, None where the backend does not say."""
    code = int(capture.get(cv2.CAP_PROP_FOURCC))
    if code <= 0:
        return None
    text = code.to_bytes(4, "little").decode("ascii", "replace").strip("\0 ")
    return text if text.isprintable() else None
