"""Random numbers keyed by (seed, stream, interval, pixel): the same on any number of threads.

A key starts a SplitMix64 sequence (Steele, Lea, Flood, OOPSLA 2014): every number is a hash of the
key and of how many were drawn before it, so no state is kept and no order of pixels is implied.
"""

import math
import zlib
from typing import Any

import numpy as np

from .kernel import kernel

START, CROSSINGS = np.uint64(1), np.uint64(2)  # streams: what the numbers are for

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1, _MIX_2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_27, _30, _31, _11 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(11)


@kernel
def mix(z: Any) -> Any:
    """SplitMix64's finaliser: each input bit flips about half of the output bits."""
    z = (z ^ (z >> _30)) * _MIX_1
    z = (z ^ (z >> _27)) * _MIX_2
    return z ^ (z >> _31)


@kernel
def sequence(seed: Any, stream: Any, interval: Any, pixel: Any) -> Any:
    """The start (uint64) of the sequence that belongs to one pixel in one interval."""
    return mix(mix(mix(seed * _GOLDEN + stream) + np.uint64(interval)) + np.uint64(pixel))


@kernel
def uniform(state: Any) -> Any:
    """(next state, uniform number in the open interval (0, 1))."""
    state = state + _GOLDEN
    return state, (np.float64(mix(state) >> _11) + 0.5) * (1.0 / 9007199254740992.0)


@kernel
def normal(state: Any) -> Any:
    """(next state, standard normal number), by Box and Muller."""
    state, radius = uniform(state)
    state, angle = uniform(state)
    return state, math.sqrt(-2.0 * math.log(radius)) * math.cos(2.0 * math.pi * angle)


def pattern(seed: int, name: str) -> np.random.Generator:
    """The numbers of a fixed pattern: the same for the same seed and effect, whatever else is on."""
    return np.random.default_rng([seed, zlib.crc32(name.encode())])
