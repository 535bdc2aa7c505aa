"""The receivers of `voltcam bench transports`, each the only thing in its process:

    python -m voltcam_server.bench.receivers NAME ADDRESS PACKET_BYTES

For each packet a REPORT goes to standard output; the bench ends the process when it has seen enough.
"""

import json
import os
import socket
import struct
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from voltcam_client.encodings import ENCODINGS
from voltcam_client.formats.ros_messages import PACKET, register
from voltcam_client.packet import TOPIC_EVENTS, Packet, decode_packet, unpack_message

REPORT = struct.Struct("<qqq")
"""Events of a packet, time of its newest, us since 1970, and when the program had it, ns since 1970."""
HEAD = struct.Struct("<qq")
"""What a packet of a plain socket begins with: as many events as it stands for, and their time, us."""
IO_S = 10.0
DATAGRAMS = 64  # of a full packet
SPIF_TIME_BITS = 15  # in each of x and y
FOXGLOVE_DATA = struct.Struct("<BIQ")  # opcode 1, subscription, time in ns: Foxglove's protocol, ws-protocol

Received = Iterator[tuple[int, int]]
"""Events of each packet, or pictures: 1; and the time of its newest, us."""


def _of(packet: Packet) -> tuple[int, int]:
    return packet.events.size, int(packet.events["t"][-1])


def tcp(address: str, packet_bytes: int) -> Received:
    """A plain socket: bytes that nobody looks at."""
    packet = bytearray(packet_bytes)
    with socket.create_connection(_host_port(address), IO_S) as connection:
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

    reader = dv_processing.io.NetworkReader(*_host_port(address))
    while reader.isRunning():
        batch = reader.getNextEventBatch()
        if batch is not None:
            yield batch.size(), batch.getHighestTime()


def ros1(address: str, _packet_bytes: int) -> Received:
    """TCPROS from the node at this address, and rosbags' deserialiser."""
    from voltcam_client.ros1.tcpros import encode_fields, receive_fields, receive_message
    from voltcam_client.ros1.xml_rpc import call

    topic, read = "/dvs/events", _typestore("ros1_noetic").deserialize_ros1
    _, host, port = call(address, "requestTopic", "/bench", topic, [["TCPROS"]])
    with socket.create_connection((host, port), IO_S) as connection:
        wanted = {"callerid": "/bench", "md5sum": "*", "tcp_nodelay": "1", "topic": topic, "type": "*"}
        connection.sendall(encode_fields(wanted))
        receive_fields(connection, IO_S)
        connection.settimeout(None)  # the bench ends this process
        while True:
            yield _of_ros(read(receive_message(connection, 1 << 20), PACKET))


def ros2(address: str, _packet_bytes: int) -> Received:
    """Cyclone DDS, and rosbags' deserialiser."""
    from voltcam_client.ros2.message_types import EVENTS
    from voltcam_client.ros2.names import Ros2Place
    from voltcam_client.ros2.participant import join

    read = _typestore("ros2_humble").deserialize_cdr
    reader = join(Ros2Place.of()).reader(address, EVENTS)
    while True:
        for cdr in reader.take(IO_S):
            yield _of_ros(read(cdr, PACKET))


def foxglove(topic: str, address: str, _packet_bytes: int) -> Received:
    """The library `websockets`; pictures of a topic, which nobody looks at."""
    from websockets.sync.client import connect
    from websockets.typing import Subprotocol

    with connect(address, subprotocols=[Subprotocol("foxglove.sdk.v1")], max_size=None, proxy=None) as client:
        channels: dict[str, int] = {}
        while topic not in channels:
            said = json.loads(client.recv(IO_S))
            channels |= {each["topic"]: each["id"] for each in said.get("channels", [])}
        wanted = [{"id": 0, "channelId": channels[topic]}]
        client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        while True:
            data = client.recv()
            if isinstance(data, bytes):
                yield 1, FOXGLOVE_DATA.unpack_from(data)[2] // 1000


def udp(
    event_bytes: int, decode: Callable[[memoryview], tuple[int, int]], address: str, _packet_bytes: int
) -> Received:
    """Datagrams, with as much room for those that wait as the system gives; those of a packet together."""
    from ..transports.udp import DATAGRAM_EVENTS

    full_bytes = event_bytes * DATAGRAM_EVENTS
    buffer = memoryview(bytearray(DATAGRAMS * full_bytes))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(_host_port(address))
        while True:
            end, taken = 0, full_bytes
            while taken == full_bytes and end < len(buffer):
                taken = receiver.recv_into(buffer[end:])
                end += taken
            yield decode(buffer[:end])


def plain_datagrams(event_bytes: int, data: memoryview) -> tuple[int, int]:
    """Bytes that nobody looks at; of one time."""
    return len(data) // event_bytes, HEAD.unpack_from(data)[1]


def spif(data: memoryview) -> tuple[int, int]:
    """The form has no times: the bench puts them into x and y."""
    words = np.frombuffer(data, "<u4")
    x, y, _on = words >> 16 & 0x7FFF, words & 0x7FFF, words >> 15 & 1
    return words.size, _recent(int(x[-1]) << SPIF_TIME_BITS | int(y[-1]), 2 * SPIF_TIME_BITS)


def t32_x16_y15_on1(data: memoryview) -> tuple[int, int]:
    from ..transports.udp import RECORD

    records = np.frombuffer(data, RECORD)
    _y, _on = records["y_on"] >> 1, records["y_on"] & 1
    return records.size, _recent(int(records["t"][-1]), 32)


def _recent(low_us: int, bits: int) -> int:
    """The last time, us since 1970, that ends in these bits."""
    now_us = time.time_ns() // 1000
    return now_us - (now_us - low_us) % (1 << bits)


def _host_port(address: str) -> tuple[str, int]:
    host, _, port = address.rpartition(":")
    return host, int(port)


def _typestore(release: str) -> Any:
    """Of rosbags, which reads messages by code of its own."""
    from rosbags import typesys

    store = typesys.get_typestore(typesys.Stores(release))
    register(store, typesys)
    return store


def _of_ros(packet: Any) -> tuple[int, int]:
    events = ENCODINGS[packet.encoding].decode(packet.events, packet.time_base // 1000)
    return events.size, int(events["t"][-1])


RECEIVERS: dict[str, Callable[[str, int], Received]] = {
    "tcp": tcp,
    "zeromq": zeromq,
    "websocket": websocket,
    "dv": dv,
    "ros1": ros1,
    "ros2": ros2,
    "udp spif": partial(udp, 4, spif),
    "udp t32_x16_y15_on1": partial(udp, 8, t32_x16_y15_on1),
    "udp, 4 bytes an event": partial(udp, 4, partial(plain_datagrams, 4)),
    "udp, 8 bytes an event": partial(udp, 8, partial(plain_datagrams, 8)),
    "foxglove frames": partial(foxglove, "/image_raw"),
    "foxglove preview": partial(foxglove, "/events/preview"),
}


def main() -> None:
    name, address, packet_bytes = sys.argv[1:]
    for events, newest_us in RECEIVERS[name](address, int(packet_bytes)):
        os.write(1, REPORT.pack(events, newest_us, time.time_ns()))


if __name__ == "__main__":
    main()
