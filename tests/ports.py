"""Ports for tests that must know one before anybody listens there."""

import os
import socket
from itertools import count

LOWEST, COUNT = 20_000, 12_000
"""Below the ports that the system gives to whoever asks for any."""
_next = count(37 * os.getpid())


def free_port() -> int:
    """A port of 127.0.0.1, TCP and UDP, where nobody listens; other processes begin to look elsewhere."""
    while True:
        port = LOWEST + next(_next) % COUNT
        with socket.socket() as tcp, socket.socket(type=socket.SOCK_DGRAM) as udp:
            try:
                tcp.bind(("127.0.0.1", port))
                udp.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
