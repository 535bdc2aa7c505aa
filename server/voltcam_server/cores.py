"""How many threads simulate one sensor on this machine."""

import math

import joblib

from voltcam_simulator.pixel_array import BAND_PIXELS

WAKING_PIXELS = 4 * BAND_PIXELS
"""Of a thread that sleeps between two frames: its waking takes about as long as so many pixels do."""


def threads_for(width: int, height: int, live: bool = False) -> int:
    """As many as this process may use cores, a container's share counted, and no more than there is work.

    live: frames come one by one, and threads sleep between them. 346x260 at 60 frames/s took 3.5 ms a frame
    with two threads then, and 2.6 with one; without a pause 1.5 and 1.6.
    """
    pixels = WAKING_PIXELS if live else BAND_PIXELS
    return max(1, min(int(joblib.cpu_count()), math.ceil(width * height / pixels)))
