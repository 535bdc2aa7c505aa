"""The exponential of a whole plane, several pixels at a time: 2^n e^r, |r| <= ln(2)/2, by series."""

from typing import Any

import numpy as np

from .kernel import kernel

_LOG2_E, _LN_2 = np.float32(1.4426950408889634), np.float32(0.6931471805599453)
_LOWEST, _HIGHEST = np.float32(-87), np.float32(88)  # e^x is a normal float32
_HALF, _1 = np.float32(0.5), np.float32(1)
_C2, _C3, _C4, _C5, _C6 = (np.float32(1 / n) for n in (2, 6, 24, 120, 720))
_BIAS, _EXPONENT_BITS = np.int32(127), np.int32(23)


@kernel
def power_of_e(x: Any) -> Any:
    """e^x of a float32 number; relative error below 2e-7 (1 + |x|), x held in -87..88."""
    clipped = min(max(x, _LOWEST), _HIGHEST)
    scaled = clipped * _LOG2_E + _HALF
    n = np.int32(scaled)
    n -= np.int32(np.float32(n) > scaled)  # rounded down, also below 0
    r = clipped - np.float32(n) * _LN_2
    series = _1 + r * (_1 + r * (_C2 + r * (_C3 + r * (_C4 + r * (_C5 + r * _C6)))))
    return series * np.int32((n + _BIAS) << _EXPONENT_BITS).view(np.float32)


@kernel
def exponential(x: Any) -> None:
    """x becomes e^x in place, a float32 plane."""
    for i in range(x.shape[0]):
        x[i] = power_of_e(x[i])
