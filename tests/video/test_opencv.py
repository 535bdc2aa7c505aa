"""OpenCV as the rest sees it: quiet, its backends by name, pixel formats as text."""

import subprocess
import sys

import cv2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_video import opencv
from voltcam_video.opencv import backends, fourcc_text


class Capture:
    """A capture that knows its pixel format only."""

    def __init__(self, code: float) -> None:
        self.code = code

    def get(self, prop: int, /) -> float:
        return self.code if prop == cv2.CAP_PROP_FOURCC else -1


@pytest.mark.parametrize("name", ["MJPG", "YUYV", "H264"])
def test_a_pixel_format_is_read_as_opencv_writes_it(name: str) -> None:
    assert fourcc_text(Capture(cv2.VideoWriter.fourcc(*name))) == name  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("code", "text"),
    [
        (0, None),
        (-1, None),
        (int.from_bytes(b"Y8  ", "little"), "Y8"),
        (int.from_bytes(b"h\0\0\0", "little"), "h"),
        (0x01020304, None),  # no letters
    ],
)
def test_what_a_backend_does_not_say_is_none(code: int, text: str | None) -> None:
    assert fourcc_text(Capture(code)) == text  # type: ignore[arg-type]


@given(st.integers(-(2**31), 2**31 - 1))
def test_any_code_gives_text_that_can_be_shown_or_none(code: int) -> None:
    text = fourcc_text(Capture(float(code)))  # type: ignore[arg-type]
    assert text is None or (text.isprintable() and len(text) <= 4)


def test_backends_are_those_that_opencv_has_built_in() -> None:
    """The registry's answer, against the summary of the build."""
    names = backends()
    assert names == sorted(set(names))
    assert ("FFMPEG" in names) == ("FFMPEG:                      YES" in cv2.getBuildInformation())
    assert "" not in names


def test_a_backend_that_cannot_be_loaded_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    class Registry:
        @staticmethod
        def getStreamBackends() -> list[int]:  # noqa: N802
            return [1, 2]

        @staticmethod
        def getCameraBackends() -> list[int]:  # noqa: N802
            return [2, 3]

        @staticmethod
        def hasBackend(number: int) -> bool:  # noqa: N802
            return number != 3

        @staticmethod
        def getBackendName(number: int) -> str:  # noqa: N802
            return {1: "V4L2", 2: "FFMPEG", 3: "GSTREAMER"}[number]

    monkeypatch.setattr(opencv.cv2, "videoio_registry", Registry)
    assert backends() == ["FFMPEG", "V4L2"]


@pytest.mark.parametrize("asked", [False, True])
def test_it_is_quiet_unless_the_user_asks(asked: bool) -> None:
    """A file that is no video: OpenCV and ffmpeg complain of it, or not."""
    code = (
        "import os, sys; "
        "[os.environ.pop(n, 0) for n in ('OPENCV_LOG_LEVEL', 'OPENCV_FFMPEG_LOGLEVEL')]; "
        + ("os.environ.update(OPENCV_LOG_LEVEL='DEBUG', OPENCV_FFMPEG_LOGLEVEL='56'); " if asked else "")
        + "from voltcam_video.opencv import cv2; cv2.VideoCapture(sys.executable).isOpened()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert bool(done.stdout + done.stderr) == asked
