"""Frames between two frames without motion: each pixel's ln L follows a monotone cubic in time.

ln L, L = F + DARK_DN, is what a pixel sees. The slopes at the frames are those of F. N. Fritsch and J.
Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5
(1984): the weighted harmonic mean of the secants on both sides, 0 where they differ in sign. So the curve has
no corner at a frame, and no extremum between frames: an overshoot would be false events.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_video.frame import Frame
from voltcam_video.interval import DARK_DN, instants

STEPS = 4  # chords that miss the cubic by 5 % of the change at most; 8 were no better on real events
STRAIGHT = 0.02  # of ln L, a tenth of a threshold: a curve that near to its chord is its chord

Plane = NDArray[Any]  # float32 (H, W)


def along_cubic(before: Frame | None, former: Frame, frame: Frame, after: Frame | None) -> Iterator[Frame]:
    """The float32 frames between `former` and `frame`; `before` and `after` bend the curve if given.

    Nothing if no pixel leaves its straight line.
    """
    start, end, span_us = _log(former), _log(frame), frame.t_us - former.t_us
    change = end - start
    bend0 = bend1 = np.zeros_like(change)  # slope at the start and end, minus that of the chord; per interval
    if before is not None:
        ratio = span_us / (former.t_us - before.t_us)
        bend0 = _slope((start - _log(before)) * ratio, change, 1 / ratio) - change
    if after is not None:
        ratio = span_us / (after.t_us - frame.t_us)
        bend1 = _slope((_log(after) - end) * ratio, change, 1 / ratio) - change
    # A slope's basis polynomial, s (1 - s)^2, is 4/27 at most.
    if np.max(np.abs(bend0) + np.abs(bend1)) * 4 / 27 < STRAIGHT:
        return
    for t_us, gone in instants(former.t_us, frame.t_us, STEPS):
        s, rest = np.float32(gone), np.float32(1 - gone)
        log = start + s * change + s * rest * (rest * bend0 - s * bend1)
        yield Frame(np.maximum(np.exp(log) - np.float32(DARK_DN), 0), t_us)


def _log(frame: Frame) -> Plane:
    log: Plane = np.log(frame.image.astype(np.float32) + np.float32(DARK_DN))
    return log


def _slope(other: Plane, chord: Plane, span: float) -> Plane:
    """At the frame between two intervals, this one of span 1 and the other of `span`, from their secants."""
    product = other * chord
    # The shorter interval's secant weighs more: 2 of the one's span and 1 of the other's.
    harmonic = (2 + span) * chord + (1 + 2 * span) * other
    slope: Plane = np.divide((3 + 3 * span) * product, harmonic, np.zeros_like(product), where=product > 0)
    return slope
