"""TCPROS: each message after its length (u32), the first in either direction a map of text.

What comes from the network has a bound and a time: a length is believed only up to the bound, and memory is
taken as bytes come.
"""

import socket
import time
from collections.abc import Mapping

from voltcam_client.ros1 import RosError

FIELDS_BYTES = 1 << 20  # most of a map: a definition of a message is in it
CHUNK_BYTES = 1 << 20


def encode_fields(fields: Mapping[str, str]) -> bytes:
    """A map, with its length."""
    lines = [f"{key}={value}".encode() for key, value in fields.items()]
    body = b"".join(len(line).to_bytes(4, "little") + line for line in lines)
    return len(body).to_bytes(4, "little") + body


def decode_fields(body: bytes) -> dict[str, str]:
    """A map, without its length. Raises RosError."""
    fields, at = {}, 0
    while at < len(body):
        size = int.from_bytes(body[at : at + 4], "little")
        line = body[at + 4 : at + 4 + size]
        key, is_field, value = line.partition(b"=")
        if at + 4 + size > len(body) or not is_field:
            raise RosError("a connection's header is no list of KEY=VALUE: does a ROS 1 node talk there?")
        fields[key.decode(errors="replace")] = value.decode(errors="replace")
        at += 4 + size
    return fields


def receive_fields(connection: socket.socket, timeout_s: float) -> dict[str, str]:
    """The map that a connection begins with, within so long. Raises RosError, OSError."""
    until_s = time.monotonic() + timeout_s
    return decode_fields(receive_message(connection, FIELDS_BYTES, until_s))


def receive_message(
    connection: socket.socket, most_bytes: int, until_s: float | None = None, begin: bytes = b""
) -> bytes:
    """The next message, without its length, where one of most_bytes may come.

    until_s: of `time.monotonic`, None: for ever. begin: what was received of it before.
    Raises RosError, EOFError at an end between two messages, and OSError.
    """
    head = begin + _exactly(connection, 4 - len(begin), until_s)
    size = int.from_bytes(head, "little")
    if size > most_bytes:
        raise RosError(f"a message of {size} bytes, of which {most_bytes} are taken: send a smaller one")
    try:
        return _exactly(connection, size, until_s)
    except EOFError:
        raise RosError(f"a message of {size} bytes was cut short: did its node end?") from None


def _exactly(connection: socket.socket, size: int, until_s: float | None) -> bytes:
    received = bytearray()
    while len(received) < size:
        if until_s is not None:
            left_s = until_s - time.monotonic()
            if left_s <= 0:
                raise TimeoutError("nothing came in time")
            connection.settimeout(left_s)
        part = connection.recv(min(CHUNK_BYTES, size - len(received)))
        if not part:
            raise EOFError
        received += part
    return bytes(received)
