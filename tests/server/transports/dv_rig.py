"""A DV transport under test, and packets for it."""

from collections.abc import Iterator

import numpy as np

from voltcam_client.packet import EVENT, Packet
from voltcam_server.transports import DvTransport

WIDTH, HEIGHT = 346, 260


def packet(seq: int, count: int = 2) -> Packet:
    events = np.zeros(count, EVENT)
    events["t"], events["x"], events["p"] = 1000 * seq + np.arange(count), seq % WIDTH, seq % 2
    return Packet(events=events, width=WIDTH, height=HEIGHT, seq=seq, time_base_ns=0, stamp_ns=1)


def started() -> Iterator[DvTransport]:
    """For a fixture."""
    transport = DvTransport("127.0.0.1:0", WIDTH, HEIGHT, "EMU00001")
    transport.start()
    yield transport
    transport.stop()


def port_of(transport: DvTransport) -> int:
    return int(transport.address.rpartition(":")[2])
