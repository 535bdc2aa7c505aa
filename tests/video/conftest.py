"""Helpers of the video tests: ffmpeg, an MJPEG server that can stall and die, a clock that does not tick."""

import contextlib
import shutil
import subprocess
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import cv2
import numpy as np
import pytest

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


class MjpegServer:
    """An HTTP camera: frame i is all grey 10 + 8 i; 50 frames per second until told otherwise."""

    def __init__(self, port: int = 0) -> None:
        self.stalled = threading.Event()
        self.dead = threading.Event()
        camera = self

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, format: str, *args: object) -> None:
                pass

            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
                self.end_headers()
                with contextlib.suppress(OSError):  # the client left
                    camera.send(self.wfile.write)

        self._http = ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self._http.daemon_threads = True
        self.port = self._http.server_address[1]
        self.url = f"http://127.0.0.1:{self.port}/"
        threading.Thread(target=self._http.serve_forever, args=(0.02,), daemon=True).start()

    def send(self, write: Callable[[bytes], object]) -> None:
        i = 0
        while not self.dead.wait(0.02):
            if self.stalled.is_set():
                continue
            image = np.full((48, 64), 10 + 8 * i % 240, np.uint8)
            jpeg = cv2.imencode(".jpg", image)[1].tobytes()
            head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
            write(head.encode() + jpeg + b"\r\n")
            i += 1

    def die(self) -> None:
        """Closes all connections and the port."""
        self.dead.set()
        self._http.shutdown()
        self._http.server_close()


@pytest.fixture
def mjpeg_server() -> Iterator[Callable[..., MjpegServer]]:
    """Starts MJPEG cameras, which end with the test."""
    running: list[MjpegServer] = []

    def start(port: int = 0) -> MjpegServer:
        running.append(MjpegServer(port))
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
