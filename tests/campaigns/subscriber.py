"""A subscriber of the soak, a process of its own: `python -m tests.campaigns.subscriber KIND ENDPOINT`.

KIND: steady, slow (a pause after each packet) or fleeting (a new connection every few seconds). On SIGTERM
it says what it saw, as a line of JSON: packets, how many were lost, how many stamps went back, and for each
packet with a loss before it the daemon's count of frames it had dropped.
"""

import json
import os
import signal
import sys
import time

import numpy as np

from voltcam_client import EventCamera

SLOW_S, FLEETING_S = 0.05, 3.0


class _Ended(Exception):  # noqa: N818  # a way out, not an error
    pass


def _end(*_: object) -> None:
    raise _Ended


def main(kind: str, endpoint: str) -> None:
    signal.signal(signal.SIGTERM, _end)
    os.nice(5)  # as on a machine of its own: the daemon is to be tried, not the scheduler
    seen = {"kind": kind, "packets": 0, "lost": 0, "backwards": 0, "latencies_ms": []}
    try:
        while True:
            with EventCamera(endpoint) as camera:
                _watch(camera, seen, kind)
    except _Ended:
        latencies = np.array(seen.pop("latencies_ms") or [0.0])
        seen["latency_p50_ms"], seen["latency_p99_ms"] = np.percentile(latencies, [50, 99]).round(2).tolist()
        sys.stdout.write(json.dumps(seen) + "\n")


def _watch(camera: EventCamera, seen: dict, kind: str) -> None:
    last_us, former, until_s = -1, 0, time.monotonic() + FLEETING_S
    for packet in camera:
        seen["packets"] += 1
        if packet.events.size:
            seen["backwards"] += int(packet.events["t"][0] < last_us)
            last_us = int(packet.events["t"][-1])
        if camera.lost_packets != former:
            seen["lost"] += camera.lost_packets - former
            former = camera.lost_packets
        if camera.latency_us is not None and seen["packets"] % 100 == 0 and len(seen["latencies_ms"]) < 10**6:
            seen["latencies_ms"].append(camera.latency_us / 1000)
        if kind == "slow":
            time.sleep(SLOW_S)
        if kind == "fleeting" and time.monotonic() > until_s:
            return


if __name__ == "__main__":
    main(*sys.argv[1:])
