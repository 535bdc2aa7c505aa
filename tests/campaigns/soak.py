"""`make soak MINUTES=n`: a camera left running, while all that is legal is tried on it, and more.

346 x 260 pixels at 60 frames/s; ten subscribers, of which three are slow and two come and go; parameters
drawn from their whole ranges every second; other sources; garbage on both ports. Twice a minute all is put
back: then it must be itself again within RECOVERY_S, and what is sent new.

It fails where the daemon ends, where it holds more than MOST_RSS_MB or ever more, where stamps go back, or
where a subscriber that keeps up has lost packets.
"""

import argparse
import json
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from tqdm import tqdm

from .daemon import Daemon, until
from .legal import Legal

MEMORY_BYTES = 8_000_000_000  # of address space
MOST_RSS_MB = 2000.0
SLOPE_MB_PER_HOUR, SLOPE_FROM_MINUTES = 60.0, 10  # a line needs some length
RECOVERY_S = 8.0  # the interval at hand, which may take seconds, and 3 s
KINDS = ["steady"] * 5 + ["slow"] * 3 + ["fleeting"] * 2
NEW_MS, MOST_LOAD = 200, 1.5
WILD_S, CALM_S = 20, 10
GARBAGE = [
    b"\0" * 4096,
    b"GET " + b"/" * 9000,
    b"\xff\0\0\0\0\0\0\0\1\x7f" + b"x" * 64,
    b"PATCH / HTTP/1.1\r\n" * 50,
]


class Soak:
    """One run: what is done to the daemon, and what was seen."""

    def __init__(self, daemon: Daemon, folder: Path, seed: int) -> None:
        self._daemon, self._folder = daemon, folder
        self._rng = np.random.default_rng(seed)
        self._legal = Legal(daemon.get("parameters/schema"), seed)
        self._base = daemon.get("parameters")["parameters"]
        self.rss_mb: list[tuple[float, float]] = []
        self.calm_rss_mb: list[tuple[float, float]] = []
        self.recoveries_s: list[float] = []
        self.calm_ages_ms: list[float] = []
        self.wild_ages_ms: list[float] = []
        self.refused: list[str] = []
        self.late: list[str] = []  # what the status said where it was not itself again
        self._began_s = time.monotonic()

    def run(self, seconds: float) -> None:
        with tqdm(total=round(seconds), unit="s", mininterval=5) as bar:
            while (passed_s := time.monotonic() - self._began_s) < seconds:
                bar.update(round(passed_s) - bar.n)
                self._wild()
                self._calm()

    def _wild(self) -> None:
        for second in range(WILD_S):
            began_s = time.monotonic()
            answer = self._daemon.http.patch("parameters", json=self._legal.change())
            if not answer.is_success:
                self.refused.append(answer.text[:200])
            if second % 5 == 2:
                self._send_garbage()
            if second % 7 == 3:
                self._swap_source()
            self.wild_ages_ms.append(self._look())
            time.sleep(max(0.0, 1 - (time.monotonic() - began_s)))

    def _calm(self) -> None:
        self._daemon.http.patch("parameters", json=self._base).raise_for_status()
        self._daemon.http.put("source", json=SCENE).raise_for_status()
        self.recoveries_s.append(until(self._is_itself, 4 * RECOVERY_S))
        if self.recoveries_s[-1] > RECOVERY_S:
            self.late.append(str({key: self._daemon.get("status")[key] for key in SHOWN}))
        for _ in range(CALM_S):
            self.calm_ages_ms.append(self._look())
            time.sleep(1)
        self.calm_rss_mb.append(self.rss_mb[-1])

    def _is_itself(self) -> bool:
        """Whether what is sent is new, as before; a machine at its limit may drop a frame now and then."""
        status = self._daemon.get("status")
        well = status["state"] in ("running", "overloaded") and status["load"] < MOST_LOAD
        return bool(well and status["latency"]["age_ms"] < NEW_MS)

    def _look(self) -> float:
        self.rss_mb.append((time.monotonic() - self._began_s, self._daemon.rss_mb))
        return float(self._daemon.get("status")["latency"]["age_ms"])

    def _swap_source(self) -> None:
        """Others that work, and some that do not: these are refused, and change nothing."""
        others = [
            SCENE | {"fps": 120},
            SCENE | {"width": 64, "height": 48},
            {"uri": "walk.npz", "loop": True},
        ]
        others += [
            {"uri": "none.mp4"},
            {"uri": "../../etc/passwd"},
            {"uri": "http://127.0.0.1:1/"},
            {"uri": "99"},
        ]
        self._daemon.http.put("source", json=others[self._rng.integers(len(others))])

    def _send_garbage(self) -> None:
        page, zmq = self._daemon.url.split("//")[1].rstrip("/"), self._daemon.get("camera")["zmq"]
        for address in (page, zmq.removeprefix("tcp://")):
            host, port = address.split(":")
            try:
                with socket.create_connection((host, int(port)), timeout=5) as connection:
                    connection.sendall(GARBAGE[self._rng.integers(len(GARBAGE))])
            except OSError:
                continue  # it hung up: so it should


SHOWN = ("state", "reason", "load", "latency", "source", "frames")
SCENE = {"uri": "scene", "fps": 60, "width": 346, "height": 260}


def main() -> int:
    """Run the soak; returns 1 where something did not hold."""
    parser = argparse.ArgumentParser(prog="make soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        frames = np.random.default_rng(1).integers(0, 255, (60, 48, 64), np.uint8)
        np.savez(folder / "walk.npz", frames=frames, t_us=20_000 * np.arange(60))
        config = folder / "voltcam.yaml"
        config.write_text(f"{{access: {{source_folders: [{folder}]}}, recordings: {folder}}}")
        source = ["--source", "scene", "--fps", "60", "--width", "346", "--height", "260"]
        with Daemon("--config", str(config), *source, memory_bytes=MEMORY_BYTES) as daemon:
            return _campaign(daemon, folder, 60 * arguments.minutes, arguments.seed)


def _campaign(daemon: Daemon, folder: Path, seconds: float, seed: int) -> int:
    endpoint = daemon.get("camera")["zmq"]
    subscribers = [_subscriber(kind, endpoint) for kind in KINDS]
    soak = Soak(daemon, folder, seed)
    try:
        soak.run(seconds)
        status = daemon.get("status")
    finally:
        for subscriber in subscribers:
            subscriber.send_signal(signal.SIGTERM)
        seen = [json.loads(each.communicate(timeout=60)[0] or "{}") for each in subscribers]
    rss_mb = daemon.most_rss_mb
    code, end_s, errors = daemon.end()
    slope = _slope_mb_per_hour(soak.calm_rss_mb)
    held = {
        "no change refused": not soak.refused,
        f"memory below {MOST_RSS_MB:.0f} MB": rss_mb < MOST_RSS_MB,
        "memory flat": seconds < 60 * SLOPE_FROM_MINUTES or slope < SLOPE_MB_PER_HOUR,
        f"itself again within {RECOVERY_S} s": max(soak.recoveries_s) < RECOVERY_S,
        "who keeps up loses nothing": not any(
            each.get("lost", 1) for each in seen if each.get("kind") != "slow"
        ),
        "stamps never go back": not any(each.get("backwards", 1) for each in seen),
        "every subscriber heard": all(each.get("packets", 0) > 100 for each in seen),
        "ended in good order": (code, errors) == (0, ""),
    }
    lines = [
        f"{seconds / 60:.0f} minutes; refused: {soak.refused[:3]}",
        f"memory: {rss_mb:.0f} MB at most, slope of the later half, in calm, {slope:+.1f} MB an hour; calm: "
        + " ".join(f"{mb:.0f}" for _, mb in soak.calm_rss_mb),
        f"frames: {status['frames']}, skipped {status['skipped_us'] / 1e6:.0f} s of the stream",
        f"age of what is sent, ms: calm {_spread(soak.calm_ages_ms)}; wild {_spread(soak.wild_ages_ms)}",
        *soak.late[:5],
        f"recovery, s: {_spread(soak.recoveries_s)}",
        *(str(each) for each in seen),
        f"end: status {code} in {end_s:.1f} s {errors}",
        *(f"{'held' if yes else 'NOT HELD'}: {what}" for what, yes in held.items()),
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0 if all(held.values()) else 1


def _subscriber(kind: str, endpoint: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "tests.campaigns.subscriber", kind, endpoint]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def _slope_mb_per_hour(samples: list[tuple[float, float]]) -> float:
    """A straight line through the second half of (s, MB)."""
    half = np.array(samples[len(samples) // 2 :])
    return float(np.polyfit(half[:, 0] / 3600, half[:, 1], 1)[0])


def _spread(values: list[float]) -> str:
    p50, p99 = np.percentile(values, [50, 99], method="higher")
    return f"p50 {p50:.1f}, p99 {p99:.1f}, most {max(values):.1f}"


if __name__ == "__main__":
    sys.exit(main())
