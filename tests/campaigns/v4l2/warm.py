"""Compiles what the guest's camera needs for the guest's processor: `python -m ... CAMERA`."""

import sys

import numpy as np

from voltcam_simulator import Camera, Simulator


def main(camera: str) -> None:
    parameters = Camera.load(camera).parameters
    for dtype in (np.uint8, np.float32):
        simulator = Simulator(64, 36, parameters, seed=1)
        for i in range(30):
            simulator.advance(np.full((36, 64), 200 if i % 2 else 20, dtype), i * 100_000)


if __name__ == "__main__":
    main(sys.argv[1])
