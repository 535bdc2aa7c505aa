"""`make patches COUNT=n`: random legal changes of parameters, as fast as the daemon takes them.

It fails when a change is refused, when the daemon needs more memory than MEMORY_BYTES, when nothing is
simulated for longer than STALL_S, or when it is not itself again RECOVERY_S after its parameters are.
"""

import argparse
import sys
import tempfile
import threading
import time
from pathlib import Path

import yaml
from tqdm import tqdm

from voltcam_simulator import Camera

from .daemon import Daemon, until
from .legal import Legal

MEMORY_BYTES = 6_000_000_000  # of address space, most of it never touched: threads, libraries, kernels
MOST_RSS_MB = 2000.0
STALL_S = 10.0
RECOVERY_S = 15.0  # a stall at the end of the changes, and 3 s
BURST = 50  # changes on top of each other; then all is put back
RESTS = 20  # how often it is watched until it is itself again


class Watch:
    """Asks for the status beside the changes: how long nothing is simulated, how old what is sent."""

    def __init__(self, daemon: Daemon) -> None:
        self.stall_s = self.age_s = 0.0
        self.states: dict[str, int] = {}
        self._daemon, self._done = daemon, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        self._done.set()
        self._thread.join(60)

    def _run(self) -> None:
        finished, since_s = -1, time.monotonic()
        while not self._done.wait(0.1):
            status = self._daemon.get("status")
            frames = status["frames"]["simulated"] + status["frames"]["skipped"]
            now_s = time.monotonic()
            if frames != finished:
                finished, since_s = frames, now_s
            self.stall_s = max(self.stall_s, now_s - since_s)
            self.age_s = max(self.age_s, status["latency"]["age_ms"] / 1000)
            self.states[status["state"]] = self.states.get(status["state"], 0) + 1


def main() -> int:
    """Run the campaign; returns 1 where something did not hold."""
    parser = argparse.ArgumentParser(prog="make patches", description=__doc__)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    source = ["--source", "scene", "--fps", "60", "--width", "64", "--height", "48"]
    with tempfile.TemporaryDirectory() as folder:
        camera = _small(folder)
        with Daemon("--camera", camera, *source, memory_bytes=MEMORY_BYTES) as daemon:
            return _campaign(daemon, arguments.count, arguments.seed)


def _small(folder: str) -> str:
    """A camera file of 64 x 48 pixels with all effects at typical values."""
    camera = Camera.load("typical")
    file = Path(folder) / "small.yaml"
    size = {"name": "small", "width": 64, "height": 48}
    file.write_text(yaml.safe_dump(size | camera.parameters.model_dump()))
    return str(file)


def _campaign(daemon: Daemon, count: int, seed: int) -> int:
    legal, watch = Legal(daemon.get("parameters/schema"), seed), Watch(daemon)
    base = daemon.get("parameters")["parameters"]
    refused, recoveries, began_s = [], [], time.monotonic()
    for done in tqdm(range(count), unit="patch", mininterval=5):
        change = legal.change()
        answer = daemon.http.patch("parameters", json=change)
        if not answer.is_success:
            refused.append(f"{answer.status_code} {answer.text[:200]}: {change}")
        if done % BURST == BURST - 1:
            daemon.http.patch("parameters", json=base).raise_for_status()
        if done % max(BURST, count // RESTS) == BURST - 1:
            recoveries.append(until(lambda: daemon.get("status")["state"] == "running", 2 * RECOVERY_S))
    per_s = count / (time.monotonic() - began_s)
    daemon.http.patch("parameters", json=base).raise_for_status()
    recoveries.append(until(lambda: daemon.get("status")["state"] == "running", 2 * RECOVERY_S))
    watch.stop()
    frames, rss_mb = daemon.get("status")["frames"], daemon.most_rss_mb
    code, end_s, errors = daemon.end()
    lines = [
        f"{count} changes, {per_s:.0f} a second; {len(refused)} refused",
        *refused[:5],
        f"memory: {rss_mb:.0f} MB at most",
        f"longest stall {watch.stall_s:.1f} s, oldest events {watch.age_s:.1f} s; states {watch.states}",
        f"frames: {frames}",
        f"recovery: {' '.join(f'{s:.1f}' for s in recoveries)} s",
        f"end: status {code} in {end_s:.1f} s {errors}",
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    held = (
        not refused
        and rss_mb < MOST_RSS_MB
        and watch.stall_s < STALL_S
        and max(recoveries) < RECOVERY_S
        and (code, errors) == (0, "")
    )
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
