"""What dv-processing's NetworkWriter sends, as the oracle of our bytes."""

import importlib.util
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Sent = Callable[[str], tuple[bytes, bytes]]


@pytest.fixture(scope="session")
def sent_by_dv() -> Sent:
    """sent_by_dv(kind): the header of such a stream, and its one packet."""
    if importlib.util.find_spec("dv_processing") is None:
        pytest.skip("dv-processing, the oracle, is not installed")
    return _sent


def _sent(kind: str) -> tuple[bytes, bytes]:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, str(Path(__file__).with_name("network_writer.py")), kind, str(port)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as writer:
        assert writer.stdout is not None
        assert writer.stdout.readline() == b"listening\n"
        with socket.create_connection(("127.0.0.1", port), timeout=30) as connection:
            header = _read(connection, 4)
            header += _read(connection, int.from_bytes(header, "little"))
            head = _read(connection, 8)
            assert head[:4] == bytes(4)
            packet = _read(connection, int.from_bytes(head[4:], "little"))
        writer.communicate(timeout=30)
    return header, packet


def _read(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        more = connection.recv(size - len(data))
        assert more, "the writer has ended the connection"
        data += more
    return data
