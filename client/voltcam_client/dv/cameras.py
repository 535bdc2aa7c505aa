"""The cameras whose DV streams a daemon serves, found by the headers of these."""

import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass

from voltcam_client.dv.flatbuffer import PREFIX
from voltcam_client.dv.streams import MOST_HEADER_BYTES, DvStream, read_header
from voltcam_client.errors import PacketError

DEFAULT_ADDRESS = "127.0.0.1:7777"
PORTS = 4  # of a camera: events, frames, triggers, IMU
MOST_CAMERAS = 16  # of a daemon
KINDS = ("EVTS", "FRME", "TRIG", "IMUS")
CONNECT_S, ANSWER_S = 0.5, 5.0


@dataclass(frozen=True, slots=True)
class FoundCamera:
    """A camera: its streams by kind, and the ports where they are."""

    host: str
    ports: dict[str, int]
    stream: DvStream

    @property
    def serial(self) -> str:
        return self.stream.source.partition("_")[2]


def find(address: str) -> Iterator[FoundCamera]:
    """The cameras of the daemon at HOST:PORT: the first one's streams are there, further ones' behind."""
    host, _, first = address.rpartition(":")
    host = host.strip("[]")
    for port in range(int(first), int(first) + PORTS * MOST_CAMERAS, PORTS):
        stream = _stream_at(host, port)
        if stream is None:
            return
        ports = {"EVTS": port}
        for offset, kind in enumerate(KINDS[1:], 1):
            other = _stream_at(host, port + offset)
            if other is not None and (other.kind, other.source) == (kind, stream.source):
                ports[kind] = port + offset
        yield FoundCamera(host, ports, stream)


def _stream_at(host: str, port: int) -> DvStream | None:
    """What its header says; None where nothing listens, or something else does."""
    try:
        with socket.create_connection((host, port), CONNECT_S) as connection:
            until_s = time.monotonic() + ANSWER_S
            head = _read(connection, PREFIX.size, until_s)
            (size,) = PREFIX.unpack(head)
            if size > MOST_HEADER_BYTES:
                return None
            streams = read_header(head + _read(connection, size, until_s)).streams
    except (OSError, PacketError):
        return None
    return streams[0] if streams else None


def _read(connection: socket.socket, size: int, until_s: float) -> bytes:
    """So many bytes. Raises OSError where they do not come until then."""
    data = bytearray()
    while len(data) < size:
        connection.settimeout(max(1e-3, until_s - time.monotonic()))
        more = connection.recv(size - len(data))
        if not more or time.monotonic() > until_s:
            raise OSError("the header does not come")
        data += more
    return bytes(data)
