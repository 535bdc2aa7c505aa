"""The receivers of `voltcam bench transports`, each the only thing in its process:

    python -m voltcam_server.bench_receivers NAME ADDRESS PACKET_BYTES

For each packet a REPORT goes to standard output; the bench ends the process when it has seen enough.
"""

import os
import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator

from voltcam_client.packet import TOPIC_EVENTS, Packet, decode_packet, unpack_message

REPORT = struct.Struct("<qqq")
"""Events of a packet, time of its newest, us since 1970, and when the program had it, ns since 1970."""
HEAD = struct.Struct("<qq")
"""What a packet of the plain socket begins with: as many events as it stands for, and their time, us."""
IO_S = 10.0

Received = Iterator[tuple[int, int]]
"""Events of each packet, and the time of its newest, us."""


def _of(packet: Packet) -> tuple[int, int]:
    return packet.events.size, int(packet.events["t"][-1])


def tcp(address: str, packet_bytes: int) -> Received:
    """A plain socket: bytes that nobody looks at."""
    host, _, port = address.rpartition(":")
    packet = bytearray(packet_bytes)
    with socket.create_connection((host, int(port)), IO_S) as connection:
        connection.settimeout(None)  # MSG_WAITALL needs it; the bench ends this process
        while connection.recv_into(packet, packet_bytes, socket.MSG_WAITALL) == packet_bytes:
            yield HEAD.unpack_from(packet)


def zeromq(address: str, _packet_bytes: int) -> Received:
    """libzmq, and our decoder."""
    import zmq

    with zmq.Context() as context, context.socket(zmq.SUB) as subscriber:
        subscriber.connect(address)
        subscriber.subscribe(TOPIC_EVENTS)
        while True:
            _, header, buffer = subscriber.recv_multipart(copy=False)
            yield _of(decode_packet(header.buffer, buffer.buffer))


def websocket(address: str, _packet_bytes: int) -> Received:
    """The library `websockets`, and our decoder."""
    from websockets.sync.client import connect

    with connect(address, max_size=None, compression=None) as client:
        while True:
            yield _of(decode_packet(*unpack_message(client.recv(decode=False))))


def dv(address: str, _packet_bytes: int) -> Received:
    """dv-processing's NetworkReader."""
    import dv_processing

    host, _, port = address.rpartition(":")
    reader = dv_processing.io.NetworkReader(host, int(port))
    while reader.isRunning():
        batch = reader.getNextEventBatch()
        if batch is not None:
            yield batch.size(), batch.getHighestTime()


RECEIVERS: dict[str, Callable[[str, int], Received]] = {
    "tcp": tcp, "zeromq": zeromq, "websocket": websocket, "dv": dv,
}  # fmt: skip


def main() -> None:
    name, address, packet_bytes = sys.argv[1:]
    for events, newest_us in RECEIVERS[name](address, int(packet_bytes)):
        os.write(1, REPORT.pack(events, newest_us, time.time_ns()))


if __name__ == "__main__":
    main()
