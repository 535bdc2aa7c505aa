"""How many threads simulate one sensor on this machine."""

import math

import joblib

from voltcam_simulator.pixel_array import BAND_PIXELS


def threads_for(width: int, height: int) -> int:
    """As many as this process may use cores, a container's share counted, and no more than there is work."""
    return max(1, min(int(joblib.cpu_count()), math.ceil(width * height / BAND_PIXELS)))
