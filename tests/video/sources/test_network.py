"""Streams on loopback. RTSP is served by a relay in this file: ffmpeg sends RTP but cannot serve RTSP."""

import contextlib
import socket
import socketserver
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from tests.ports import free_port

from voltcam_video import Frame, Source, SourceError, SourceRequest, open_source

if TYPE_CHECKING:
    from tests.mjpeg_server import MjpegServer


def read(source: Source, count: int) -> list[Frame]:
    return [frame for frame in (source.read() for _ in range(count)) if frame]


def open_soon(uri: str, timeout_s: float = 3) -> Source:
    """Opens a stream whose sender is just starting."""
    deadline_s = time.monotonic() + 15
    while True:
        try:
            return open_source(SourceRequest(uri=uri, timeout_s=timeout_s))
        except SourceError:
            if time.monotonic() > deadline_s:
                raise


def check_moving_pictures(source: Source, rate: float, size: tuple[int, int] = (120, 160)) -> None:
    before_us = time.time_ns() // 1000
    frames = read(source, 45)
    after_us = time.time_ns() // 1000
    times_us = np.array([frame.t_us for frame in frames])
    assert all(frame.image.shape == size for frame in frames)
    assert any((a.image != b.image).any() for a, b in pairwise(frames))
    assert (np.diff(times_us) > 0).all()
    assert before_us - 50_000 <= times_us[0] <= times_us[-1] <= after_us + 50_000
    # Frames arrive as fast as they are sent: nothing was held back and released in a burst.
    assert 44e6 / (times_us[-1] - times_us[0]) == pytest.approx(rate, rel=0.25)


def test_mjpeg_over_http(mjpeg_server: Callable[..., "MjpegServer"]) -> None:
    with open_source(SourceRequest(uri=mjpeg_server().url, timeout_s=3)) as source:
        granted = source.granted
        frames = read(source, 10)
    assert (granted["kind"], granted["live"], granted["clock"]) == ("network", True, "arrival")
    assert (granted["width"], granted["height"], granted["pixel_format"]) == (64, 48, "MJPG")
    greys = [frame.image.mean() for frame in frames]
    np.testing.assert_allclose(np.diff(greys) % 240, 8, atol=1.5)  # none lost, none twice


def test_a_stalled_stream_raises_in_time(mjpeg_server: Callable[..., "MjpegServer"]) -> None:
    server = mjpeg_server()
    with open_source(SourceRequest(uri=server.url, timeout_s=0.7)) as source:
        read(source, 3)
        server.stalled.set()
        start_s = time.monotonic()
        with pytest.raises(SourceError, match=r"no frame for 0\.7 s; the stream stalled"):
            read(source, 100)
        assert time.monotonic() - start_s > 0.6


def test_a_server_that_dies_ends_the_stream(
    mjpeg_server: Callable[..., "MjpegServer"], capfd: pytest.CaptureFixture[str]
) -> None:
    server = mjpeg_server()
    with open_source(SourceRequest(uri=server.url, timeout_s=3)) as source:
        read(source, 3)
        server.dead.set()
        with pytest.raises(SourceError, match="the stream ended"):
            read(source, 100)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("scheme", ["http", "rtsp", "udp"])
def test_nobody_there(scheme: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(
        SourceError, match=rf"{scheme}://u:\*\*\*@127.* no stream there within 0\.5 s"
    ) as error:
        open_source(SourceRequest(uri=f"{scheme}://u:secret@127.0.0.1:{free_port()}", timeout_s=0.5))
    assert "secret" not in str(error.value)
    assert capfd.readouterr() == ("", "")


def test_mpegts_over_udp(ffmpeg_sender: Callable[..., Any]) -> None:
    url = f"udp://127.0.0.1:{free_port()}"
    ffmpeg_sender(
        "-c:v", "libx264", "-tune", "zerolatency", "-g", "10", "-f", "mpegts", f"{url}?pkt_size=1316"
    )
    with open_soon(url) as source:
        check_moving_pictures(source, 30)


def test_mpegts_over_http_served_by_ffmpeg(ffmpeg_sender: Callable[..., Any]) -> None:
    url = f"http://127.0.0.1:{free_port()}/live.ts"
    sender = ffmpeg_sender("-c:v", "mpeg4", "-g", "10", "-f", "mpegts", "-listen", "1", url)
    with open_soon(url) as source:
        check_moving_pictures(source, 30)
        sender.kill()
        with pytest.raises(SourceError, match="the stream ended"):
            read(source, 100)


class RtspRelay(socketserver.StreamRequestHandler):
    """Just enough RTSP (RFC 2326) to hand the RTP packets that come in by UDP on to a client over TCP."""

    SDP = "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=-\r\nt=0 0\r\nm=video 0 RTP/AVP 26\r\na=control:0\r\n"
    rtp: socket.socket

    def handle(self) -> None:
        while request := self.rfile.readline().decode().split():
            headers = dict(
                line.split(": ", 1) for line in iter(lambda: self.rfile.readline().decode(), "\r\n")
            )
            answer, body = {"CSeq": headers["CSeq"].strip(), "Session": "1"}, ""
            if request[0] == "OPTIONS":
                answer["Public"] = "DESCRIBE, SETUP, PLAY, TEARDOWN"
            elif request[0] == "DESCRIBE":
                body = self.SDP
                answer |= {"Content-Type": "application/sdp", "Content-Length": str(len(body))}
            elif request[0] == "SETUP":
                answer["Transport"] = "RTP/AVP/TCP;unicast;interleaved=0-1"
            head = "".join(f"{key}: {value}\r\n" for key, value in answer.items())
            self.wfile.write(f"RTSP/1.0 200 OK\r\n{head}\r\n{body}".encode())
            if request[0] == "PLAY":
                self.relay()
                return

    def relay(self) -> None:
        with contextlib.suppress(OSError):  # the client left, or nothing comes any more
            while True:
                packet = self.rtp.recv(65536)
                self.wfile.write(b"$\0" + len(packet).to_bytes(2, "big") + packet)


@pytest.fixture
def rtsp_url(ffmpeg_sender: Callable[..., Any]) -> Iterator[str]:
    with socket.socket(type=socket.SOCK_DGRAM) as rtp:
        rtp.bind(("127.0.0.1", 0))
        rtp.settimeout(3)
        handler = type("Handler", (RtspRelay,), {"rtp": rtp})
        with socketserver.ThreadingTCPServer(("127.0.0.1", 0), handler) as server:
            server.daemon_threads = True
            threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
            target = f"rtp://127.0.0.1:{rtp.getsockname()[1]}"
            # RTP carries baseline JPEG with the standard tables only (RFC 2435).
            ffmpeg_sender("-c:v", "mjpeg", "-huffman", "default", "-pix_fmt", "yuvj420p", "-f", "rtp", target)
            yield f"rtsp://127.0.0.1:{server.server_address[1]}/live"
            server.shutdown()


def test_rtsp(rtsp_url: str) -> None:
    with open_source(SourceRequest(uri=rtsp_url, timeout_s=5)) as source:
        check_moving_pictures(source, 30)


def test_a_file_behind_a_url_is_no_stream(tmp_path: Path, ffmpeg: Callable[..., None]) -> None:
    ffmpeg("-f", "lavfi", "-i", "testsrc=duration=1", "-movflags", "+faststart", tmp_path / "clip.mp4")

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, format: str, *args: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(tmp_path))) as server:
        threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
        url = f"http://127.0.0.1:{server.server_address[1]}/clip.mp4"
        with pytest.raises(SourceError, match="a file, not a stream; download it"):
            open_source(SourceRequest(uri=url, timeout_s=3))
        server.shutdown()
