"""The frames beside the events, and what an input path gets wrong about them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .scene import Scene

SAMPLES = 9  # of an exposure


@dataclass(frozen=True)
class Film:
    """grey = 255 (gain L/255)^gamma + black level, cut at 255, L the mean radiance of the exposure."""

    gamma: float = 1.0
    black_level_dn: float = 0.0
    exposure_us: float = 0.0
    gain: float = 1.0  # above 1 the brightest parts clip


STRAIGHT = Film()
FAULTS = ("gamma", "black_level", "exposure_blur", "clipping")


def draw_film(rng: np.random.Generator, fault: str) -> Film:
    """One of FAULTS, at a size seen in practice. Low frame rates and 8 bit are arguments of `record`."""
    if fault == "gamma":
        return Film(gamma=float(rng.uniform(0.45, 0.8)))
    if fault == "black_level":
        return Film(black_level_dn=float(rng.uniform(4, 16)))
    if fault == "exposure_blur":
        return Film(exposure_us=float(rng.uniform(4_000, 15_000)))
    if fault == "clipping":
        return Film(gain=float(rng.uniform(1.3, 2.0)))
    raise ValueError(f"no fault {fault!r}: take one of {FAULTS}")


def exposed(
    scene: Scene, frame_t_us: NDArray[np.int64], film: Film, eight_bit: bool, rng: np.random.Generator
) -> NDArray[Any]:
    """(frames, height, width), uint8 rounded to nearest or float32."""
    offsets = film.exposure_us * (np.arange(SAMPLES) / SAMPLES + 0.5 / SAMPLES - 0.5)
    if film.exposure_us == 0:
        offsets = offsets[:1]
    light = sum(scene.radiance(frame_t_us + offset) / np.float32(len(offsets)) for offset in offsets)
    grey = 255 * (np.clip(film.gain * np.asarray(light) / 255, 0, 1)) ** film.gamma + film.black_level_dn
    grey = np.clip(grey, 0, 255)
    return np.rint(grey).astype(np.uint8) if eight_bit else grey.astype(np.float32)
