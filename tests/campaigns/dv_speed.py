"""How fast DV streams are, into dv-processing's NetworkReader: `python -m tests.campaigns.dv_speed`.

Events per second of the transport, beside those of ready-made bytes from a plain socket, which is what the
loopback and the reader allow; and the latency of packets of 1 ms, from `publish` to the reader's program.
"""

import contextlib
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np

from voltcam_client.dv.file import PACKET
from voltcam_client.dv.packets import events_packet
from voltcam_client.dv.streams import DvStream, header_bytes
from voltcam_client.packet import EVENT, Packet
from voltcam_server.messages import events_message
from voltcam_server.transports import DvTransport

WIDTH, HEIGHT = 346, 260
PACKET_EVENTS = 65_536 // 8  # a daemon's largest packet
AHEAD = 60  # packets: less than what is dropped
EVENTS = 100_000_000
LATENCY_PACKETS, LATENCY_EVENTS = 5000, 1000  # a million events a second
LIMIT_S = 300

READER = """
import sys, time
import dv_processing as dv

reader, count = dv.io.NetworkReader("127.0.0.1", int(sys.argv[1])), int(sys.argv[2])
print("connected", flush=True)
late_us, began_s = [], None
while count > 0 and reader.isRunning():
    batch = reader.getNextEventBatch()
    if batch is None:
        continue
    now_us = time.time_ns() // 1000
    began_s = began_s or time.perf_counter()
    count -= batch.size()
    late_us.append(now_us - batch.getHighestTime())
late_us.sort()
rank = [late_us[int(share * (len(late_us) - 1))] for share in (0.5, 0.99)]
print(time.perf_counter() - began_s, *rank, flush=True)
"""


def _events(count: int) -> np.ndarray:
    events = np.zeros(count, EVENT)
    events["x"], events["y"] = np.arange(count) % WIDTH, np.arange(count) % HEIGHT
    return events


@contextlib.contextmanager
def _reader(port: int, count: int) -> Iterator["subprocess.Popen[str]"]:
    command = [sys.executable, "-c", READER, str(port), str(count)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "connected\n"
            yield process
        finally:
            process.kill()


def _result(process: "subprocess.Popen[str]") -> list[float]:
    """Seconds, and the latencies' median and 99th percentile in us."""
    return [float(word) for word in process.communicate(timeout=LIMIT_S)[0].split()]


def limit() -> float:
    """Events/s of ready-made bytes from a plain socket."""
    packet = events_packet(_events(PACKET_EVENTS), PACKET.size)
    PACKET.pack_into(packet, 0, 0, len(packet) - PACKET.size)
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve() -> None:
            connection, _ = listener.accept()
            with connection, contextlib.suppress(OSError):
                connection.sendall(header_bytes([DvStream(0, "EVTS", "A_1", (WIDTH, HEIGHT))]))
                for _ in range(EVENTS // PACKET_EVENTS + 1):
                    connection.sendall(packet)

        threading.Thread(target=serve, daemon=True).start()
        with _reader(listener.getsockname()[1], EVENTS) as process:
            return EVENTS / _result(process)[0]


def ours() -> float:
    """Events/s of the transport."""
    transport, events = _transport(), _events(PACKET_EVENTS)
    with _reader(_port(transport), EVENTS) as process:
        _await_reader(transport)
        for seq in range(EVENTS // PACKET_EVENTS + 1):
            while seq - transport.status.packets_sent > AHEAD:
                time.sleep(0.0002)
            transport.publish(events_message(_packet(seq, events)))
        result = _result(process)
    transport.stop()
    assert transport.status.packets_dropped == 0
    return EVENTS / result[0]


def latency_us() -> tuple[float, float]:
    """Median and 99th percentile, of packets of a thousand events each millisecond."""
    transport = _transport()
    with _reader(_port(transport), LATENCY_PACKETS * LATENCY_EVENTS) as process:
        _await_reader(transport)
        next_s = time.perf_counter()
        for seq in range(LATENCY_PACKETS):
            events = _events(LATENCY_EVENTS)
            events["t"] = time.time_ns() // 1000
            transport.publish(events_message(_packet(seq, events)))
            next_s += 0.001
            time.sleep(max(0.0, next_s - time.perf_counter()))
        _, median, late = _result(process)
    transport.stop()
    return median, late


def _transport() -> DvTransport:
    transport = DvTransport("127.0.0.1:0", WIDTH, HEIGHT, "EMU00001")
    transport.start()
    return transport


def _port(transport: DvTransport) -> int:
    return int(transport.address.rpartition(":")[2])


def _await_reader(transport: DvTransport) -> None:
    until_s = time.monotonic() + LIMIT_S
    while not transport.status.clients and time.monotonic() < until_s:
        time.sleep(0.01)


def _packet(seq: int, events: np.ndarray) -> Packet:
    return Packet(events=events, width=WIDTH, height=HEIGHT, seq=seq, time_base_ns=0, stamp_ns=0)


def main() -> None:
    sys.stdout.write(f"a plain socket  {limit() / 1e6:6.1f} million events/s\n")
    sys.stdout.write(f"the transport   {ours() / 1e6:6.1f} million events/s\n")
    median, late = latency_us()
    sys.stdout.write(f"latency         {median:6.0f} us median, {late:.0f} us 99th percentile\n")


if __name__ == "__main__":
    main()
