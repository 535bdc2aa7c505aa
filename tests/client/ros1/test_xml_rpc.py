"""Calls, and a server of calls: against the standard library's own, and against garbage."""

import contextlib
import socket
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

import numpy as np
import pytest
from tests.ports import free_port

from voltcam_client.ros1 import RosError, xml_rpc
from voltcam_client.ros1.xml_rpc import RpcServer, call


@contextlib.contextmanager
def server_of(answer: bytes, then: Callable[[socket.socket], object] = lambda _: None) -> Iterator[str]:
    """Answers a call with these bytes, and ends."""
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def run() -> None:
            connection, _ = listener.accept()
            with connection, contextlib.suppress(OSError):
                connection.recv(100_000)
                connection.sendall(answer)
                then(connection)

        thread = threading.Thread(target=run)
        thread.start()
        yield f"http://127.0.0.1:{listener.getsockname()[1]}/"
        thread.join()


@pytest.fixture
def server() -> Iterator[RpcServer]:
    def fail() -> None:
        raise ValueError("not that")

    server = RpcServer("127.0.0.1", {"add": lambda a, b: a + b, "fail": fail})
    yield server
    server.close()


def test_the_standard_library_s_client_is_answered(server: RpcServer) -> None:
    with ServerProxy(f"http://127.0.0.1:{server.port}/RPC2") as proxy:
        assert proxy.add(2, 3) == [1, "", 5]
        assert proxy.fail() == [-1, "not that", 0]
        assert proxy.nothing() == [-1, "there is no nothing here", 0]


def test_the_standard_library_s_server_is_called() -> None:
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_function(lambda a, b: [1, "", [a, b]], "pair")
        server.register_function(lambda: [-1, "not\nnow", 0], "refuse")
        threading.Thread(target=server.serve_forever, args=(0.01,)).start()
        uri = f"http://127.0.0.1:{server.server_address[1]}/"
        try:
            assert call(uri, "pair", "ä", [1, 2.5]) == ["ä", [1, 2.5]]
            with pytest.raises(RosError, match=r"refuses refuse: not now$"):
                call(uri, "refuse")
            with pytest.raises(RosError, match="is no ROS 1"):
                call(uri, "nothing")
        finally:
            server.shutdown()


def test_nobody_there() -> None:
    with pytest.raises(RosError, match=r"nobody answers at http://127\.0\.0\.1"):
        call(f"http://127.0.0.1:{free_port()}", "getPid")


@pytest.mark.parametrize("uri", ["", "11311", "https://a:1", "http://:1", "http://a:b", "http://a:99999"])
def test_what_is_no_address(uri: str) -> None:
    with pytest.raises(RosError, match="is no address of ROS 1"):
        call(uri, "getPid")


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"SSH-2.0-OpenSSH_9.2\r\n",
        b"HTTP/1.0 200 OK\r\n\r\n<methodResponse><params>",
        b"HTTP/1.0 200 OK\r\nContent-Length: 3\r\n\r\nabc",
        b"HTTP/1.0 200 OK\r\n\r\n<?xml version='1.0'?><methodResponse><params><param><value>"
        b"<int>1</int></value></param></params></methodResponse>",
        b"HTTP/1.0 200 OK\r\n\r\n" + b"<a>" * 100_000,
    ],
)
def test_what_answers_and_is_no_ros(answer: bytes) -> None:
    with server_of(answer) as uri, pytest.raises(RosError, match="is no ROS 1") as caught:
        call(uri, "getPid")
    assert "\n" not in str(caught.value)


def test_an_answer_without_end_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xml_rpc, "MOST_BYTES", 100_000)

    def flood(connection: socket.socket) -> None:
        for _ in range(1000):
            connection.sendall(bytes(10_000))

    tracemalloc.start()
    with server_of(b"HTTP/1.0 200 OK\r\n\r\n", flood) as uri, pytest.raises(RosError):
        call(uri, "getPid")
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak_bytes < 2_000_000


def test_an_answer_a_byte_at_a_time_is_not_waited_for() -> None:
    over = threading.Event()

    def drip(connection: socket.socket) -> None:
        while not over.wait(0.02):
            connection.sendall(b" ")

    began_s = time.monotonic()
    with server_of(b"HTTP/1.0 200 OK\r\n\r\n", drip) as uri:
        try:
            with pytest.raises(RosError, match="timed out"):
                call(uri, "getPid", timeout_s=0.3)
        finally:
            over.set()
    assert time.monotonic() - began_s < 5


def test_garbage_does_not_stop_the_server(server: RpcServer) -> None:
    rng = np.random.default_rng(5)
    head = b"POST / HTTP/1.0\r\nContent-Length: %d\r\n\r\n"
    attempts = [
        rng.bytes(200),
        b"POST / HTTP/1.0\r\n\r\n",
        head % (1 << 40),
        head % 10 + b"<x>",
        head % 5 + b"\xff" * 5,
    ]
    for attempt in attempts * 5:
        with socket.create_connection(("127.0.0.1", server.port)) as connection, contextlib.suppress(OSError):
            connection.sendall(attempt)
            connection.shutdown(socket.SHUT_WR)
            connection.settimeout(10)
            while connection.recv(1000):
                pass
    assert call(f"http://127.0.0.1:{server.port}/", "add", 1, 1) == 2


def test_a_call_that_is_too_long_is_refused_before_it_is_read(server: RpcServer) -> None:
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        connection.sendall(b"POST / HTTP/1.0\r\nContent-Length: 1048577\r\n\r\n")
        connection.settimeout(10)
        assert connection.recv(1000).startswith(b"HTTP/1.0 413")


def test_those_who_hold_connections_are_let_go(server: RpcServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xml_rpc._Handler, "timeout", 0.2)
    idle = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(40)]
    try:
        deadline = time.monotonic() + 20
        while True:
            try:
                assert call(f"http://127.0.0.1:{server.port}/", "add", 1, 1, timeout_s=5) == 2
                break
            except RosError:
                assert time.monotonic() < deadline
    finally:
        for connection in idle:
            connection.close()
