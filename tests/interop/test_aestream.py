"""AEStream reads the datagrams of `--udp-form spif`: a picture of events by x and y."""

import socket
import subprocess
import sys

import numpy as np
import pytest

from voltcam_client.datagrams import datagrams
from voltcam_client.encodings import EVENT

pytest.importorskip("aestream", reason="AEStream cannot be installed here")
WAIT_S = 60
READS = """
import sys, time, numpy as np, aestream
total = np.zeros((64, 48))
with aestream.UDPInput((64, 48), device="cpu", port=int(sys.argv[1])) as stream:
    time.sleep(1)
    print("listening", flush=True)
    until = time.monotonic() + 30
    while np.abs(total).sum() < int(sys.argv[2]) and time.monotonic() < until:
        time.sleep(0.05)
        total += np.asarray(stream.read())
for x, y in np.argwhere(total):
    print(x, y, int(total[x, y]), flush=True)
import os
os._exit(0)  # its thread does not end
"""


def test_each_event_arrives() -> None:
    rng = np.random.default_rng(2)
    pixels = rng.permutation(64 * 48)[:500]  # each once, so that ON and OFF cannot cancel
    events = np.zeros(500, EVENT)
    events["x"], events["y"], events["p"] = pixels // 48, pixels % 48, rng.integers(0, 2, 500)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("", 0))
        port = free.getsockname()[1]
    with subprocess.Popen(
        [sys.executable, "-c", READS, str(port), "500"], stdout=subprocess.PIPE, text=True
    ) as reader:
        assert reader.stdout is not None
        assert reader.stdout.readline() == "listening\n"
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for datagram in datagrams(events, "spif"):
                sender.sendto(datagram, ("127.0.0.1", port))
        rows = {tuple(map(int, line.split())) for line in reader.stdout}
        assert reader.wait(WAIT_S) == 0
    assert {row[:2] for row in rows} == {(int(e["x"]), int(e["y"])) for e in events}
