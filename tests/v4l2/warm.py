"""Compiles what the guest's daemon needs for the guest's processor: `python -m ... CAMERA`.

A daemon with the same camera looks at frames as a webcam gives, and at others; time is cut there, too, and
bars stand for so long that the simulator draws ahead.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from tests.campaigns.daemon import Daemon, until

from .settings import FPS, HEIGHT, LONG_S, MEMORY_BYTES, WIDTH

FRAMES = 20
STILL_US = 500_000  # after each of as many frames that are the same


def main(camera: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bars.npz"
        columns = np.arange(WIDTH) // 40 * 32
        bars = np.stack([np.tile(np.roll(columns, 8 * i), (HEIGHT, 1)) for i in range(FRAMES)])
        frames = np.concatenate([bars, np.repeat(bars[-1:], FRAMES, 0)]).astype(np.uint8)
        t_us = np.cumsum(np.repeat([1_000_000 // FPS, STILL_US], FRAMES))
        np.savez(file, frames=frames, t_us=t_us)
        source = ["--source", str(file), "--loop", "--fast", "--camera", camera, "--burst"]
        with Daemon(*source, memory_bytes=MEMORY_BYTES) as daemon:
            for turn in (1, 2):
                _wait(daemon, turn * (2 * FRAMES + 5))  # with a turn of the loop
                daemon.http.put("source", json={"uri": "scene", "fps": FPS}).raise_for_status()


def _wait(daemon: Daemon, frames: int) -> None:
    if until(lambda: daemon.get("status")["frames"]["simulated"] >= frames, LONG_S) > LONG_S:
        raise SystemExit("no frames are simulated here")


if __name__ == "__main__":
    main(sys.argv[1])
