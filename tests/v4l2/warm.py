"""A daemon as the guest's, at frames in a file: what it compiles is kept. `python -m tests.v4l2.warm CAMERA`.

It is run here for the guest's processor, as an emulated one would take minutes. Python's own compiled files of
this package come of it, too.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.campaigns.daemon import Daemon, until

from .settings import FPS, HEIGHT, LONG_S, MEMORY_BYTES, WIDTH

LOOK_S = 3


def main(camera: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "bars.npz"
        x, y = np.arange(WIDTH), np.arange(HEIGHT)[:, None]
        bars = [((x + 8 * i + 0 * y) // 40 % 2 * 180 + 40).astype(np.uint8) for i in range(50)]
        np.savez(source, frames=np.array(bars), t_us=np.arange(50) * 1_000_000 // FPS)
        arguments = ["--source", str(source), "--loop", "--camera", camera, "--burst"]
        with Daemon(*arguments, memory_bytes=MEMORY_BYTES) as daemon:
            until(lambda: daemon.get("status")["events"]["total"] > 1000, LONG_S)
            time.sleep(LOOK_S)  # frames are compiled for after the first ones, too
            daemon.end()


if __name__ == "__main__":
    main(sys.argv[1])
