"""What a camera and a stream have in common: damaged frames, stamps, losses. Each kind has its own test."""

import threading
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from voltcam_video import Clock, SourceError, SourceRequest
from voltcam_video.opencv import CvCapture
from voltcam_video.sources.live import DAMAGED_LIMIT, LiveSource


class Capture:
    """Gives images, "damaged" ones, and nothing more at the end."""

    def __init__(self, images: Iterable[Any]) -> None:
        self.images = iter(images)
        self.image: Any = None
        self.released = 0

    def grab(self) -> bool:
        self.image = next(self.images, None)
        return self.image is not None

    def retrieve(self) -> tuple[bool, Any]:
        return not isinstance(self.image, str), self.image

    def release(self) -> None:
        self.released += 1


class Live(LiveSource):
    """Frames of `Capture`, at the times it is given."""

    def __init__(self, images: Iterable[Any], times_us: Iterable[int] = range(1, 1000)) -> None:
        self.capture, self.times_us = Capture(images), iter(times_us)
        super().__init__(SourceRequest(uri="rtsp://u:secret@camera/"), Clock(), threading.Event())

    def _open(self) -> CvCapture:
        return self.capture  # type: ignore[return-value]

    def _time_us(self) -> int:
        return next(self.times_us)

    def _lost(self) -> str:
        return "rtsp://camera/: it is gone; plug it in"


def grey(level: int) -> np.ndarray:
    return np.full((2, 3, 3), level, np.uint8)


def test_it_is_live_and_never_ends_by_itself() -> None:
    assert (Live.live, Live.endless) == (True, True)


def test_frames_are_luminance_and_later_each_time() -> None:
    source = Live(map(grey, (10, 20, 30, 40)), [100, 100, 50, 200])
    frames = [source.read() for _ in range(4)]
    assert [frame.t_us for frame in frames] == [100, 101, 102, 200]
    assert [frame.image.tolist() for frame in frames] == [[[v] * 3] * 2 for v in (10, 20, 30, 40)]


def test_a_damaged_frame_is_skipped_and_leaves_no_trace_in_the_times() -> None:
    source = Live([grey(1), "damaged", grey(2)], [100, 900, 500])
    assert [source.read().t_us for _ in range(2)] == [100, 500]


@pytest.mark.parametrize("damaged", [DAMAGED_LIMIT - 1, DAMAGED_LIMIT])
def test_so_many_damaged_frames_in_a_row_are_an_error_without_the_password(damaged: int) -> None:
    source = Live(["damaged"] * damaged + [grey(7)])
    if damaged < DAMAGED_LIMIT:
        assert source.read().image[0, 0] == 7
        return
    with pytest.raises(
        SourceError, match=f"{DAMAGED_LIMIT} damaged frames in a row; check the link"
    ) as error:
        source.read()
    assert "secret" not in str(error.value)


def test_no_frame_is_the_error_of_its_kind() -> None:
    source = Live([grey(1)])
    source.read()
    with pytest.raises(SourceError, match="it is gone; plug it in"):
        source.read()


def test_it_lets_go_of_the_capture() -> None:
    with Live([]) as source:
        assert source.capture.released == 0
    assert source.capture.released == 1
