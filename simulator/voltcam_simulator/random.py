"""Random numbers keyed by (seed, stream, interval, pixel): the same on any number of threads.

A key starts a SplitMix64 sequence (Steele, Lea, Flood, OOPSLA 2014): every number is a hash of the
key and of how many were drawn before it, so no state is kept and no order of pixels is implied.
"""

import math
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .kernel import kernel

START, CROSSINGS, AHEAD, BACK = (np.uint64(i) for i in (1, 2, 3, 4))  # streams: what the numbers are for

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1, _MIX_2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_1, _2, _62, _63 = np.uint64(1), np.uint64(2), np.uint64(62), np.uint64(63)
_SQRT_HALF_BITS, _EXPONENT_BITS, _LN_2 = np.int64(0x3FE6A09E667F3BCD), np.int64(52), math.log(2.0)
_27, _30, _31, _11 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(11)
_2_TO_MINUS_53 = 2.0**-53


@kernel
def mix(z: Any) -> Any:
    """SplitMix64's finaliser: each input bit flips about half of the output bits."""
    z = (z ^ (z >> _30)) * _MIX_1
    z = (z ^ (z >> _27)) * _MIX_2
    return z ^ (z >> _31)


@kernel
def key_of_interval(seed: Any, stream: Any, interval: Any) -> Any:
    """`interval_key` for kernels; all uint64."""
    return mix(mix(seed * _GOLDEN + stream) + interval)


def interval_key(seed: int, stream: np.uint64, interval: int) -> np.uint64:
    """The part of the key that all pixels share: seed and interval 0..2^64 - 1, stream one of the above."""
    return np.uint64(key_of_interval(np.uint64(seed), stream, np.uint64(interval)))


@kernel
def sequence(key: Any, pixel: Any) -> Any:
    """The start (uint64) of the sequence that belongs to one pixel in one interval."""
    return mix(key + np.uint64(pixel))


@kernel
def uniform(state: Any) -> Any:
    """(next state, uniform number in the open interval (0, 1))."""
    state = state + _GOLDEN
    return state, (np.float64(mix(state) >> _11) + 0.5) * _2_TO_MINUS_53


_TAIL = 3.654152885361009  # where the base layer ends, for 256 layers
_LAYER_AREA = _TAIL * math.exp(-0.5 * _TAIL**2) + math.sqrt(0.5 * math.pi) * math.erfc(_TAIL / math.sqrt(2.0))


def _layers() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The 256 layers of equal area under exp(-x^2/2): their right edges x and heights exp(-x^2/2)."""
    edge = np.empty(257)
    edge[1] = _TAIL
    edge[0] = _LAYER_AREA * math.exp(0.5 * _TAIL**2)  # the base layer, as wide as if it had no tail
    for i in range(1, 255):
        height = math.exp(-0.5 * edge[i] ** 2) + _LAYER_AREA / edge[i]
        edge[i + 1] = math.sqrt(-2.0 * math.log(height))
    edge[256] = 0.0
    return edge, np.exp(-0.5 * edge**2)


_EDGE, _HEIGHT = _layers()
_LAYER_MASK, _SIGN = np.uint64(0xFF), np.uint64(0x100)


@kernel
def normal(state: Any) -> Any:
    """(next state, standard normal number), by the ziggurat of Marsaglia and Tsang (2000): 99 % of the
    numbers cost one hash, one product and one comparison."""
    while True:
        state = state + _GOLDEN
        bits = mix(state)
        layer = bits & _LAYER_MASK
        sign = 1.0 if bits & _SIGN else -1.0
        x = np.float64(bits >> _11) * _2_TO_MINUS_53 * _EDGE[layer]
        if x < _EDGE[layer + _1]:
            return state, sign * x
        state, u = uniform(state)
        if layer == 0:  # the tail beyond the last layer
            state, v = uniform(state)
            x = -math.log(u) / _TAIL
            if -2.0 * math.log(v) > x * x:
                return state, sign * (_TAIL + x)
        elif _HEIGHT[layer] + u * (_HEIGHT[layer + _1] - _HEIGHT[layer]) < math.exp(-0.5 * x * x):
            return state, sign * x


@kernel
def sequences(key: Any, pixel0: Any, pixels: Any, states: Any) -> None:
    """The starts of many pixels' sequences: states (n,) uint64 for pixel0 + pixels (n,)."""
    for i in range(pixels.shape[0]):
        states[i] = mix(key + np.uint64(pixel0 + pixels[i]))


@kernel
def uniforms(states: Any, u: Any) -> None:
    """The next uniform number of many sequences, in (0, 1)."""
    for i in range(u.shape[0]):
        states[i] += _GOLDEN
        u[i] = (np.float64(np.int64(mix(states[i]) >> _11)) + 0.5) * _2_TO_MINUS_53


@kernel
def normals(states: Any, a: Any, b: Any) -> None:
    """The next two standard normal numbers of many sequences, by Box and Muller: a, b (n,) float64.

    Plain arithmetic, which the compiler vectorises: both together cost less than one from `normal`.
    """
    uniforms(states, a)
    bits = a.view(np.int64)
    for i in range(a.shape[0]):  # u = m 2^e with m in [sqrt(1/2), sqrt(2))
        e = (bits[i] - _SQRT_HALF_BITS) >> _EXPONENT_BITS
        bits[i] -= e << _EXPONENT_BITS
        b[i] = e
    for i in range(a.shape[0]):  # radius sqrt(-2 ln u), ln m = 2 artanh((m - 1)/(m + 1))
        s = (a[i] - 1.0) / (a[i] + 1.0)
        w = s * s
        tail = 2 / 9 + w * (2 / 11 + w * (2 / 13 + w * (2 / 15 + w * (2 / 17 + w * (2 / 19)))))
        log_m = s * (2.0 + w * (2 / 3 + w * (2 / 5 + w * (2 / 7 + w * tail))))
        a[i] = math.sqrt(-2.0 * (b[i] * _LN_2 + log_m))
    for i in range(a.shape[0]):  # angle: two bits for the quadrant, the rest within it, by Taylor's series
        states[i] += _GOLDEN
        h = mix(states[i])
        t = (np.float64(np.int64((h << _2) >> _11)) * _2_TO_MINUS_53 - 0.5) * (0.5 * math.pi)
        w = t * t
        sine = -1 / 5040 + w * (1 / 362880 + w * (-1 / 39916800 + w / 6227020800))
        sine = t * (1.0 + w * (-1 / 6 + w * (1 / 120 + w * sine)))
        cosine = -1 / 720 + w * (1 / 40320 + w * (-1 / 3628800 + w / 479001600))
        cosine = 1.0 + w * (-1 / 2 + w * (1 / 24 + w * cosine))
        radius = -a[i] if h >> _63 else a[i]
        turned = (h >> _62) & _1 != 0
        a[i] = radius * (-sine if turned else cosine)
        b[i] = radius * (cosine if turned else sine)


def events_generator(seed: int, name: str, interval: int) -> np.random.Generator:
    """The numbers of an effect that works on whole intervals of events."""
    return np.random.Generator(
        np.random.Philox(key=[seed, zlib.crc32(name.encode())], counter=[0, 0, interval, 0])
    )


def events_key(seed: int, name: str, interval: int) -> np.uint64:
    """The same as the start of a sequence for kernels."""
    return interval_key(seed, np.uint64(zlib.crc32(name.encode())), interval)


def pattern(seed: int, name: str) -> np.random.Generator:
    """The numbers of a fixed pattern: the same for the same seed and effect, whatever else is on."""
    return np.random.default_rng([seed, zlib.crc32(name.encode())])
