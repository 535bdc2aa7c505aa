"""What receivers of the bench understand of datagrams, made by the transport itself."""

import socket
import time

import numpy as np
import pytest

from voltcam_server.bench import receivers, senders
from voltcam_server.bench.senders import udp_spif, udp_t32
from voltcam_server.bench.transports import events_at


@pytest.mark.parametrize(
    ("opened", "decode"),
    [(udp_spif, receivers.spif), (udp_t32, receivers.t32_x16_y15_on1)],
)
def test_a_datagram_says_how_many_events_it_has_and_when_they_were(
    opened: object, decode: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The time is cut to 30 or 32 bits on its way, and put back."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(10)
        monkeypatch.setattr(senders, "free_udp_port", receiver.getsockname)
        now_us = time.time_ns() // 1000
        with opened() as sender:  # type: ignore[operator]
            sender.send(events_at(now_us, 100))
            data = receiver.recv(4096)
    assert decode(memoryview(data)) == (100, now_us)  # type: ignore[operator]


def test_a_time_is_the_last_one_with_its_bits() -> None:
    now_us = time.time_ns() // 1000
    found = [receivers._recent(us % (1 << 30), 30) for us in range(now_us - 10**6, now_us, 10**5)]
    np.testing.assert_array_equal(found, range(now_us - 10**6, now_us, 10**5))
