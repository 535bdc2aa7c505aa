"""How far simulated events are from real ones of a scene, beside how far real ones are from themselves.

    yardstick = Yardstick(real_events, region, Light(frames, frame_t_us))
    yardstick.distances(simulated_events)["W1"], yardstick.floor_by_pixels()["W1"]

Each measure is also a function of its own, in `intervals`, `counts` and `patches`.
"""

from ..light.frame_light import FrameLight
from .counts import NoiseRates, noise_rates
from .measures import DISTANCES, HEADLINES, MEASURES, Measure, Yardstick, closest, gap
from .region import Region, by_pixels, by_time, held_out

__all__ = [
    "DISTANCES",
    "HEADLINES",
    "MEASURES",
    "FrameLight",
    "Measure",
    "NoiseRates",
    "Region",
    "Yardstick",
    "by_pixels",
    "by_time",
    "closest",
    "gap",
    "held_out",
    "noise_rates",
]
