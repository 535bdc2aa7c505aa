"""XML-RPC as ROS 1 has it: calls of a roscore or a node, and a server for theirs; bounded in bytes and time.

A call gives [code, text, value]; code 1 is good.
"""

import socket
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any
from urllib.parse import urlsplit
from xmlrpc.client import dumps, loads
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

from voltcam_client.ros1 import RosError

ANSWER_S = 5.0
MOST_BYTES = 1 << 20
CALLS_AT_ONCE = 16
END_OF_HEAD = b"\r\n\r\n"


def call(uri: str, method: str, *arguments: Any, timeout_s: float = ANSWER_S) -> Any:
    """The value that a call gives. Raises RosError in one line."""
    host, port = _address(uri)
    try:
        answer = _exchange(host, port, dumps(arguments, method).encode(), timeout_s)
    except OSError as error:
        raise RosError(f"nobody answers at {uri} ({error.strerror or error})") from None
    try:
        answered: Any = loads(answer)[0]
        ((code, text, value),) = answered
    except Exception as error:  # of XML, of XML-RPC, of its numbers and dates: each has its own
        raise RosError(
            f"what answers at {uri} is no ROS 1 ({type(error).__name__}): check the port"
        ) from None
    if code != 1:
        raise RosError(f"{uri} refuses {method}: {' '.join(str(text)[:200].split())}")
    return value


def _address(uri: str) -> tuple[str, int]:
    try:
        parts = urlsplit(uri)
        if parts.scheme == "http" and parts.hostname:
            return parts.hostname, parts.port or 80
    except ValueError:  # a port that is none
        pass
    raise RosError(f"{uri[:200]!r} is no address of ROS 1: give http://HOST:PORT")


def _exchange(host: str, port: int, body: bytes, timeout_s: float) -> bytes:
    """HTTP/1.0: the answer ends with the connection, or where its length says so. Raises OSError."""
    until_s = time.monotonic() + timeout_s
    head = f"POST / HTTP/1.0\r\nHost: {host}:{port}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}"
    received = bytearray()
    with socket.create_connection((host, port), timeout_s) as connection:
        connection.sendall(head.encode() + END_OF_HEAD + body)
        while len(received) <= MOST_BYTES and not _whole(received):
            connection.settimeout(max(0.001, until_s - time.monotonic()))
            part = connection.recv(1 << 16)
            if not part:
                break
            received += part
            if time.monotonic() > until_s:
                raise TimeoutError("timed out")
    return bytes(received.partition(END_OF_HEAD)[2])


def _whole(received: bytearray) -> bool:
    head, is_whole, body = received.partition(END_OF_HEAD)
    if not is_whole:
        return False
    for line in head.split(b"\r\n"):
        key, _, value = line.partition(b":")
        if key.lower() == b"content-length" and value.strip().isdigit():
            return len(body) >= int(value)
    return False


class _Handler(SimpleXMLRPCRequestHandler):
    """A call that is too long, or takes too long to come, ends with its connection."""

    rpc_paths = ()
    timeout = ANSWER_S

    def setup(self) -> None:
        super().setup()
        self._alarm = threading.Timer(2 * ANSWER_S, self._end)
        self._alarm.daemon = True
        self._alarm.start()

    def finish(self) -> None:
        self._alarm.cancel()
        super().finish()

    def do_POST(self) -> None:  # noqa: N802
        length = self.headers.get("content-length", "")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            self.send_error(413)
            return
        super().do_POST()

    def log_message(self, format: str, *args: object) -> None:
        """Whoever sends garbage does not fill this machine's log."""

    def decode_request_content(self, data: bytes) -> bytes | None:
        """No compression, which ROS 1 does not use."""
        return data

    def _end(self) -> None:
        try:
            self.connection.shutdown(socket.SHUT_RDWR)
        except OSError:
            return  # it has ended


class RpcServer(SimpleXMLRPCServer):
    """Answers calls of these methods, each of which gives its value; in threads of its own."""

    daemon_threads = True

    def __init__(self, address: str, methods: Mapping[str, Callable[..., Any]]) -> None:
        super().__init__((address, 0), _Handler, logRequests=False)
        self._methods = methods
        self._free = threading.BoundedSemaphore(CALLS_AT_ONCE)
        threading.Thread(
            target=self.serve_forever, args=(0.05,), name="voltcam-ros1-calls", daemon=True
        ).start()

    @property
    def port(self) -> int:
        return int(self.server_address[1])

    def close(self) -> None:
        self.shutdown()
        self.server_close()

    def process_request(self, request: Any, client_address: Any) -> None:
        """In a thread; more at once than there may be are let go."""
        if not self._free.acquire(blocking=False):
            self.shutdown_request(request)
            return
        threading.Thread(target=self._process, args=(request, client_address), daemon=True).start()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A connection that ended too early: nobody to tell."""

    def _process(self, request: Any, client_address: Any) -> None:
        try:
            self.finish_request(request, client_address)
        except Exception:
            self.handle_error(request, client_address)
        finally:
            self.shutdown_request(request)
            self._free.release()

    def _dispatch(self, method: str, params: Any) -> list[Any]:
        known = self._methods.get(method)
        if known is None:
            return [-1, f"there is no {method} here", 0]
        try:
            return [1, "", known(*params)]
        except (TypeError, ValueError) as error:
            return [-1, str(error), 0]
