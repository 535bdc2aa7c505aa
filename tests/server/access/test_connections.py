"""Bounds of HTTP connections: silent ones, heads and messages without end. Nobody else is shut out."""

import contextlib
import socket
import threading
import time

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from voltcam_server.access.connections import HEAD_BYTES, MOST_CONNECTIONS

from ..process import Daemon
from ..rig import until


def test_silent_connections_and_long_heads_do_not_shut_others_out() -> None:
    """1100 idle connections, and heads without end: REST was dead while they were held."""
    with Daemon() as daemon:
        host, port = daemon.url.removeprefix("http://").rstrip("/").split(":")
        idle: list[socket.socket] = []
        try:
            for _ in range(2 * MOST_CONNECTIONS):
                idle.append(socket.create_connection((host, int(port)), timeout=5))
            until(lambda: _answers(daemon), "REST answers again")
        finally:
            for each in idle:
                each.close()
        until(lambda: _answers(daemon), "REST answers")
        with socket.create_connection((host, int(port)), timeout=5) as long:
            long.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n")
            assert _sent_before_closed(long) < 3 * HEAD_BYTES
        assert _answers(daemon)


def test_a_long_message_of_a_websocket_client_ends_its_connection() -> None:
    with Daemon() as daemon:
        url = daemon.url.replace("http://", "ws://") + "api/v1/frames"
        with connect(url, proxy=None) as stream:
            sender = threading.Thread(target=_send_much, args=(stream,))
            sender.start()
            with pytest.raises(ConnectionClosed):
                _receive_all(stream)
            sender.join(10)
        assert _answers(daemon)


def _sent_before_closed(connection: socket.socket) -> int:
    """How many bytes of headers a connection took."""
    line = b"X-Long: " + b"x" * 4000 + b"\r\n"
    for count in range(100):
        try:
            connection.sendall(line)
        except OSError:
            return count * len(line)
        time.sleep(0.01)
    return 100 * len(line)


def _receive_all(stream: ClientConnection) -> None:
    while True:
        stream.recv(timeout=10)


def _send_much(stream: ClientConnection) -> None:
    with contextlib.suppress(ConnectionClosed):
        stream.send(b"x" * 2**20)


def _answers(daemon: Daemon) -> bool:
    try:
        return httpx.get(f"{daemon.url}healthz", trust_env=False, timeout=2).is_success
    except httpx.HTTPError:
        return False


def test_requests_that_hang_do_not_hold_the_page() -> None:
    with Daemon() as daemon:
        host, port = daemon.url.removeprefix("http://").rstrip("/").split(":")
        with socket.create_connection((host, int(port))) as slow:
            slow.sendall(
                b"PATCH /api/v1/parameters HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{"
            )
            assert httpx.get(f"{daemon.url}api/v1/status", trust_env=False).is_success
            slow.settimeout(20)
            assert slow.recv(100) == b""  # it is let go
