"""Cameras found by their DV streams; and what answers at these ports without being one."""

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator

import pytest
from tests.ports import free_port

from voltcam_client.dv import cameras
from voltcam_client.dv.cameras import find
from voltcam_client.dv.streams import DvStream, header_bytes

SIZE = (346, 260)


@contextlib.contextmanager
def answering(port: int, answer: bytes) -> Iterator[None]:
    """Says the same to each who comes, and keeps the connection."""
    kept: list[socket.socket] = []
    with socket.create_server(("127.0.0.1", port)) as listener:
        listener.settimeout(0.02)
        ended = threading.Event()

        def serve() -> None:
            while not ended.is_set():
                with contextlib.suppress(TimeoutError):
                    connection, _ = listener.accept()
                    connection.sendall(answer)
                    kept.append(connection)

        thread = threading.Thread(target=serve)
        thread.start()
        yield
        ended.set()
        thread.join()
        for connection in kept:
            connection.close()


def header(kind: str, source: str) -> bytes:
    return header_bytes([DvStream(0, kind, source, SIZE if kind in ("EVTS", "FRME") else None)])


@pytest.fixture
def first() -> int:
    """Of eight free ports."""
    while True:
        port = free_port()
        with contextlib.ExitStack() as stack, contextlib.suppress(OSError):
            for each in range(port, port + 9):
                stack.enter_context(socket.create_server(("127.0.0.1", each)))
            return port


def test_each_camera_with_its_streams(first: int) -> None:
    there = {0: ("EVTS", "DAVIS346_left"), 1: ("FRME", "DAVIS346_left"), 4: ("EVTS", "DAVIS346_right")}
    there |= {7: ("IMUS", "DAVIS346_right")}
    with contextlib.ExitStack() as stack:
        for offset, (kind, source) in there.items():
            stack.enter_context(answering(first + offset, header(kind, source)))
        left, right = find(f"127.0.0.1:{first}")
    assert (left.serial, left.stream.size, left.ports) == ("left", SIZE, {"EVTS": first, "FRME": first + 1})
    assert (right.serial, right.ports) == ("right", {"EVTS": first + 4, "IMUS": first + 7})


def test_nobody_is_there(first: int) -> None:
    assert list(find(f"127.0.0.1:{first}")) == []


@pytest.mark.parametrize(
    "make",
    [
        lambda: b"HTTP/1.1 400 Bad Request\r\n\r\n",
        lambda: b"\xff" * 100,
        lambda: b"\0" * 100,
        lambda: header("EVTS", "A_1")[:40] + b"\xff" * 2000,
        lambda: header("EVTS", "A_1")[:40],
        lambda: b"",
    ],
)
def test_something_else_is_there(
    make: Callable[[], bytes], first: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cameras, "ANSWER_S", 0.3)
    began_s = time.monotonic()
    with answering(first, make()):
        assert list(find(f"127.0.0.1:{first}")) == []
    assert time.monotonic() - began_s < 30
