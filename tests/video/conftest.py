"""Helpers of the video tests: ffmpeg, an MJPEG server that can stall and die, a clock that does not tick."""

import shutil
import subprocess
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.mjpeg_server import MjpegServer

from voltcam_video import Clock


@pytest.fixture(scope="session")
def ffmpeg() -> Callable[..., None]:
    """Runs ffmpeg to its end; the test is skipped where there is none."""
    if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
        pytest.skip("needs ffmpeg and ffprobe")

    def run(*arguments: str | Path) -> None:
        subprocess.run(
            ["ffmpeg", "-v", "error", "-nostdin", "-y", *map(str, arguments)], check=True, timeout=60
        )

    return run


@pytest.fixture
def ffmpeg_sender(ffmpeg: Callable[..., None]) -> Iterator[Callable[..., "subprocess.Popen[bytes]"]]:
    """Starts ffmpeg in the background: it sends a moving test picture; ends with the test, or in 30 s."""
    running: list[subprocess.Popen[bytes]] = []

    def start(*output: str, picture: str = "testsrc=size=160x120:rate=30") -> "subprocess.Popen[bytes]":
        command = [
            "ffmpeg",
            "-v",
            "quiet",
            "-nostdin",
            "-re",
            "-f",
            "lavfi",
            "-i",
            picture,
            "-t",
            "30",
            *output,
        ]
        running.append(subprocess.Popen(command, stderr=subprocess.DEVNULL))
        return running[-1]

    yield start
    for process in running:
        process.kill()
        process.wait(10)


def _grey(i: int) -> NDArray[np.uint8]:
    return np.full((48, 64), 10 + 8 * i % 240, np.uint8)


@pytest.fixture
def mjpeg_server() -> Iterator[Callable[..., MjpegServer]]:
    """Starts MJPEG cameras, of which frame i is all grey 10 + 8 i; they end with the test."""
    running: list[MjpegServer] = []

    def start(port: int = 0) -> MjpegServer:
        running.append(MjpegServer(_grey, port))
        return running[-1]

    yield start
    for server in running:
        server.die()


class StillClock(Clock):
    """Time passes only by waiting, which takes none."""

    def __init__(self, now_us: int) -> None:
        super().__init__()
        self.time_us = now_us
        self.waits: list[int] = []

    def now_us(self) -> int:
        return self.time_us

    def epoch_us(self, monotonic_us: int) -> int:
        return monotonic_us + 1_000_000_000

    def wait_until(self, t_us: int, stop: threading.Event) -> bool:
        self.waits.append(t_us)
        self.time_us = max(self.time_us, t_us)
        return not stop.is_set()


@pytest.fixture
def still_clock() -> StillClock:
    return StillClock(1_700_000_000_000_000)
