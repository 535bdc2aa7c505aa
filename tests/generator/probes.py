"""Small recordings and what to see in them, for the tests of the generator itself."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .base import Base
from .effects import Effect
from .recording import Recorded, record
from .scene import draw_scene, still_scene

Floats = NDArray[np.float64]
LEAKY = Base("none", k1=5.265, k2=20, k3=1e-3, k4=0, k5=1e-7, k6=0)  # 12.8 events/s at 128 DN
JUNCTION = replace(LEAKY, k4=1e-5, k5=0, k3=1e-6)  # 10 events/s
QUIET = replace(LEAKY, k3=1e-9, k5=0)
FAST = replace(QUIET, k4=5e-3)  # an event every 200 us


def seen(effect: Effect | None, base: Base = LEAKY, dn: float = 128, seconds: float = 3) -> Recorded:
    """24x16 pixels looking at one brightness."""
    effects = [effect] if effect else []
    return record(still_scene(np.full((16, 24), dn)), base, effects, seconds, seed=1)


def moving(effect: Effect | None, base: Base = QUIET, seconds: float = 2) -> Recorded:
    scene = draw_scene(np.random.default_rng(5), 24, 24)
    return record(scene, base, [effect] if effect else [], seconds, seed=1)


def intervals_us(recording: Recorded) -> Floats:
    """Between events of one pixel, all pixels; from the first second on."""
    e = recording.events
    pixel = e["y"].astype(int) * recording.width + e["x"]
    order = np.lexsort((e["t"], pixel))
    gap = np.diff(e["t"][order])
    return np.asarray(gap[(np.diff(pixel[order]) == 0) & (e["t"][order][:-1] > 1_000_000)], float)


def counts(recording: Recorded, polarity: bool | None = None) -> NDArray[np.int64]:
    """(height, width)"""
    e = recording.events if polarity is None else recording.events[recording.events["p"] == polarity]
    pixel = e["y"].astype(int) * recording.width + e["x"]
    return np.bincount(pixel, minlength=recording.width * recording.height).reshape(recording.height, -1)


def rayleigh(recording: Recorded, frequency_hz: float) -> float:
    """Mean resultant length of the events' phases."""
    return float(np.abs(np.exp(2e-6j * np.pi * frequency_hz * recording.events["t"]).mean()))
