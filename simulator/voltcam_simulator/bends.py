r"""Mean paths that are bent over a step, cut into pieces that are straight enough for the law of crossing.

A low pass whose input goes in a straight line follows a straight line, too, but for a transient that dies
away as exp(-a x), x the share of the step and a = `Bend.rate`. With q = 1 - exp(-a/2), the knots

    x_i = -(2/a) ln(1 - q i/(n - 0.31 q)),  i = 1..n - 1

are dense where the path is bent: n pieces all leave their chords by the same, C q^2/2/(n - 0.31 q)^2 for a
transient of size C at the start, to a few per cent. (Knots go as the square root of the curvature; 0.31 is
for the last piece, which has all of the tail.) How few pieces do follows from it in closed form.
"""

import math
from typing import Any

import numpy as np

from .kernel import kernel
from .logarithm import logarithm

TOLERANCE = 0.01
"""How far the mean path may be from straight pieces [nominal thresholds]: a third of how much the thresholds
of a DAVIS differ from pixel to pixel. Or, if that is more, as far as the voltage goes in"""
TOLERANCE_US = 500.0
"""this time, at its mean speed in the step, or in"""
TOLERANCE_SHARE = 1 / 64
"""this share of the step: an eighth of what a straight line between two frames may miss of the light."""
TAIL = 0.31
MOST_PIECES = 16
"""Enough for a bow of 2.4 thresholds, or more if the voltage goes as far."""
_0, _1, _2, _4, _8, _HALF, _16, _1_16TH = (np.float32(v) for v in (0, 1, 2, 4, 8, 0.5, 16, 1 / 16))
_TAIL, _MOST_PIECES = np.float32(TAIL), np.float32(MOST_PIECES)
_15, _105, _420, _945 = (np.float32(v) for v in (15, 105, 420, 945))


@kernel
def straightness(span_us: Any) -> Any:
    """(voltage, share of the way made in the step): how far a mean path may be off, the larger of both."""
    return np.float32(TOLERANCE), np.float32(max(TOLERANCE_US / span_us, TOLERANCE_SHARE))


@kernel
def fading(rate: Any) -> Any:
    """q of a pixel, to 3e-8: with y = x^2, tanh x = x (945 + 105 y + y^2)/(945 + 420 y + 15 y^2) at
    x = a/16 <= 1 gives E = exp(-a/8) and P = (1 - E)/(a/8), and twice P(2b) = P(b) (1 + E(b))/2 and
    E(2b) = E(b)^2; q = a/2 P(a/2). Beyond a = 16 it is 1. Plain arithmetic, which the compiler vectorises."""
    x = _1_16TH * min(rate, _16)
    y = x * x
    top, bottom = _945 + y * (_105 + y), _945 + y * (_420 + _15 * y)
    inverse = _1 / (bottom + x * top)
    e, p = (bottom - x * top) * inverse, top * inverse
    p *= _HALF * (_1 + e)
    e *= e
    p *= _HALF * (_1 + e)
    return _HALF * rate * p if rate <= _16 else _1


@kernel
def depth(rate: Any) -> Any:
    """The largest distance of exp(-a x) from its chord, 1 - P + P ln P with P = (1 - exp(-a))/a, to 3 %."""
    return rate * rate / (_8 + rate * (_4 + rate))


@kernel
def count_pieces(bow: Any, drift: Any, rate: Any, q: Any, span_us: Any, pieces: Any) -> Any:
    """Fill pieces with how many straight ones do for each path; returns the most. (m,) float32."""
    tolerance, share = straightness(span_us)
    for k in range(pieces.shape[0]):
        allowed = max(tolerance, share * abs(drift[k]))
        pieces[k] = q[k] * (_TAIL + math.sqrt(_HALF * abs(bow[k]) / (depth(rate[k]) * allowed)))
    most = _1
    for k in range(pieces.shape[0]):
        needed = min(pieces[k], _MOST_PIECES) if pieces[k] > _1 else _1  # 1 also for NaN: it becomes a place
        whole = np.float32(np.int32(needed))
        pieces[k] = whole if whole == needed else whole + _1
        most = max(most, pieces[k])
    return int(most)


@kernel
def find_knots(number: Any, pieces: Any, rate: Any, q: Any, share: Any, line: Any, work: Any) -> None:
    """Where piece `number` of each path ends; (m,) float32 or longer, m that of share.

    share becomes the share of the step, line the distance of the path from the straight line there, in bows;
    work (m or more,).
    """
    m, number = share.shape[0], np.float32(number)
    left = work[:m]
    for k in range(m):
        inner = _1 - q[k] * number / (pieces[k] - _TAIL * q[k])
        left[k] = inner if number < pieces[k] else _1
    for k in range(m):
        share[k] = _0 - _2 * logarithm(left[k]) / rate[k] if number < pieces[k] else _1
    for k in range(m):
        away = (_1 - left[k] * left[k] - q[k] * (_2 - q[k]) * share[k]) / depth(rate[k])
        line[k] = away if number < pieces[k] else _0
