"""The camera logic, against a stand-in for OpenCV's capture: there is no camera on the machines that test."""

import errno
import os
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
import pytest

from voltcam_video import Clock, SourceError, SourceRequest, open_source
from voltcam_video.sources.device import DeviceSource, kernel_time_us

if TYPE_CHECKING:
    from ..conftest import StillClock

BOOT_US = 1_000_000_000  # StillClock's epoch time of monotonic 0
NOW_US = 1_700_000_000_000_000


class FakeCapture:
    """A camera of any size, at 30 fps only. `frames`: stamps in ms and images, None for a damaged one."""

    def __init__(self, frames: Sequence[tuple[float, np.ndarray | None]], opened: bool = True) -> None:
        self.frames = iter(frames)
        self.opened = opened
        self.calls: list[tuple[int, float]] = []
        self.properties: dict[int, float] = {
            cv2.CAP_PROP_FRAME_WIDTH: 640,
            cv2.CAP_PROP_FRAME_HEIGHT: 480,
            cv2.CAP_PROP_FPS: 30,
            cv2.CAP_PROP_FOURCC: cv2.VideoWriter.fourcc(*"YUYV"),
        }
        self.image: np.ndarray | None = None

    def isOpened(self) -> bool:  # noqa: N802
        return self.opened

    def set(self, prop: int, value: float, /) -> bool:
        self.calls.append((prop, value))
        if prop == cv2.CAP_PROP_FPS:
            return False
        self.properties[prop] = value
        return True

    def get(self, prop: int, /) -> float:
        return self.properties.get(prop, 0)

    def grab(self) -> bool:
        stamp_ms, self.image = next(self.frames, (None, None))
        if stamp_ms is None:
            return False
        self.properties[cv2.CAP_PROP_POS_MSEC] = stamp_ms
        return True

    def retrieve(self) -> tuple[bool, Any]:
        return self.image is not None, self.image

    def release(self) -> None:
        self.opened = False

    def getBackendName(self) -> str:  # noqa: N802
        return "V4L2"


IMAGE = np.full((480, 640, 3), 90, np.uint8)


@pytest.fixture
def device(tmp_path: Path) -> Iterator[str]:
    """A file that can be opened, in place of /dev/video0."""
    path = tmp_path / "video0"
    path.touch()
    yield str(path)
    os.environ.pop("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", None)


def open_fake(capture: FakeCapture, clock: Clock, uri: str, **asked: Any) -> DeviceSource:
    def open_capture(path: str, backend: int) -> FakeCapture:
        assert (path, backend) == (uri, cv2.CAP_V4L2)
        return capture

    return DeviceSource(SourceRequest(uri=uri, **asked), clock, threading.Event(), open_capture)


def monotonic_ms(epoch_us: int) -> float:
    return (epoch_us - BOOT_US) / 1000


def test_frames_carry_the_kernels_time(device: str, still_clock: "StillClock") -> None:
    times_us = [NOW_US - 60_000, NOW_US - 26_667, NOW_US - 1]
    capture = FakeCapture([(monotonic_ms(t), IMAGE) for t in times_us])
    with open_fake(capture, still_clock, device) as source:
        frames = [source.read(), source.read()]  # the first was used to look at its stamp
        assert source.granted["clock"] == "kernel"
    assert [frame.t_us for frame in frames] == times_us[1:]
    assert (frames[0].image == 90).all()
    assert frames[0].image.shape == (480, 640)
    assert not capture.opened


@pytest.mark.parametrize("stamp_ms", [0.0, -1.0, 5e15, monotonic_ms(NOW_US - 3_600_000_000)])
def test_frames_without_a_useful_stamp_carry_their_arrival(
    device: str, still_clock: "StillClock", stamp_ms: float
) -> None:
    with open_fake(FakeCapture([(stamp_ms, IMAGE)] * 2), still_clock, device) as source:
        assert source.granted["clock"] == "arrival"
        assert source.read().t_us == NOW_US


def test_stamps_on_the_wall_clock_are_known_too(still_clock: "StillClock") -> None:
    assert kernel_time_us(NOW_US - 40_000, still_clock) == NOW_US - 40_000
    assert kernel_time_us(NOW_US - 40_000 - BOOT_US, still_clock) == NOW_US - 40_000


def test_times_never_repeat_or_go_back(device: str, still_clock: "StillClock") -> None:
    times_us = [NOW_US - 50_000, NOW_US - 30_000, NOW_US - 30_000, NOW_US - 40_000, NOW_US - 10_000]
    capture = FakeCapture([(monotonic_ms(t), IMAGE) for t in times_us])
    with open_fake(capture, still_clock, device) as source:
        got = [source.read().t_us - NOW_US for _ in range(4)]
    assert got == [-30_000, -29_999, -29_998, -10_000]


def test_what_is_asked_and_what_is_granted(device: str, still_clock: "StillClock") -> None:
    capture = FakeCapture([(0, IMAGE)])
    asked = {"width": 1280, "height": 720, "fps": 120, "pixel_format": "MJPG"}
    with open_fake(capture, still_clock, device, **asked) as source:
        granted = source.granted
    mjpg = cv2.VideoWriter.fourcc(*"MJPG")
    assert capture.calls == [
        (cv2.CAP_PROP_FOURCC, mjpg),  # before the size: the format limits it
        (cv2.CAP_PROP_FRAME_WIDTH, 1280),
        (cv2.CAP_PROP_FRAME_HEIGHT, 720),
        (cv2.CAP_PROP_FPS, 120),
    ]
    assert (granted["kind"], granted["live"], granted["backend"]) == ("device", True, "V4L2")
    assert (granted["width"], granted["height"]) == (1280, 720)
    assert (granted["fps"], granted["pixel_format"]) == (30, "MJPG")


def test_one_side_alone_keeps_the_other(device: str, still_clock: "StillClock") -> None:
    capture = FakeCapture([(0, IMAGE)])
    with open_fake(capture, still_clock, device, width=320):
        pass
    assert capture.calls == [(cv2.CAP_PROP_FRAME_WIDTH, 320), (cv2.CAP_PROP_FRAME_HEIGHT, 480)]


def test_nothing_asked_changes_nothing(device: str, still_clock: "StillClock") -> None:
    capture = FakeCapture([(0, IMAGE)])
    with open_fake(capture, still_clock, device):
        pass
    assert capture.calls == []


def test_a_damaged_frame_is_skipped(device: str, still_clock: "StillClock") -> None:
    capture = FakeCapture([(0, IMAGE), (0, None), (0, IMAGE + 1)])
    with open_fake(capture, still_clock, device) as source:
        assert (source.read().image == 91).all()


def test_only_damaged_frames_are_an_error(device: str, still_clock: "StillClock") -> None:
    capture = FakeCapture([(0, IMAGE), *[(0, None)] * 40])
    with (
        open_fake(capture, still_clock, device) as source,
        pytest.raises(SourceError, match="damaged frames in a row"),
    ):
        source.read()


def test_stalled_and_unplugged(device: str, still_clock: "StillClock") -> None:
    with open_fake(FakeCapture([(0, IMAGE)]), still_clock, device) as source:
        with pytest.raises(SourceError, match="no frame came; the camera stalled"):
            source.read()
        Path(device).unlink()
        with pytest.raises(SourceError, match="unplugged; plug it in again"):
            source.read()


def test_a_camera_that_is_gone_while_its_file_is_there(
    device: str, still_clock: "StillClock", monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the kernel has it while somebody holds the camera open."""

    def refuse(*_: object) -> int:
        raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))

    with open_fake(FakeCapture([(0, IMAGE)]), still_clock, device) as source:
        monkeypatch.setattr(os, "open", refuse)
        with pytest.raises(SourceError, match="unplugged; plug it in again"):
            source.read()


def test_a_camera_just_let_go_is_waited_for(device: str, still_clock: "StillClock") -> None:
    """By itself: the daemon lets it go, too, when it is to be opened with another size."""
    capture = FakeCapture([(0, IMAGE), (10, IMAGE)], opened=False)
    threading.Timer(0.15, lambda: setattr(capture, "opened", True)).start()
    with open_fake(capture, still_clock, device) as source:
        assert source.read().t_us > 0


def test_busy_camera(device: str, still_clock: "StillClock") -> None:
    with pytest.raises(SourceError, match=r"another program has it \(fuser -v"):
        open_fake(FakeCapture([], opened=False), still_clock, device)
    with pytest.raises(SourceError, match="opened, but no frame came"):
        open_fake(FakeCapture([]), still_clock, device)


@pytest.mark.parametrize(
    ("code", "message"),
    [(errno.EACCES, "usermod -aG video"), (errno.EBUSY, "busy; fuser -v"), (errno.ENODEV, "No such device")],
)
def test_a_device_file_that_cannot_be_opened(
    device: str, still_clock: "StillClock", monkeypatch: pytest.MonkeyPatch, code: int, message: str
) -> None:
    def refuse(*_: object) -> int:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(SourceError, match=message):
        open_fake(FakeCapture([]), still_clock, device)


def test_a_missing_camera_lists_those_there_are(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SourceError, match=r"/dev/video97: no such device; there (are|is no) /dev/video"):
        open_source(SourceRequest(uri="97"))
    assert capfd.readouterr() == ("", "")


def test_what_is_no_camera(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SourceError, match="/dev/null: cannot capture"):
        open_source(SourceRequest(uri="/dev/null"))
    assert capfd.readouterr() == ("", "")
