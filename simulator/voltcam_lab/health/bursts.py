"""Events that come with the camera's frames: the moments around a frame to mask.

A moment is one with more events than other moments of the same frames have: by a t test over the frames, so
that a scene's own bursts do not count, at several widths, for ON and OFF, for pixels at rest and others.
t above 5 in about 2000 tests: less than 1 % to find one where there is none.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..windows import Mask, Windows, around, joined, within
from .row_scan import RowScan, without_delay_us
from .subject import Subject

_WIDTHS_US = (100, 400, 1600, 5000)
_T_TEST = 5.0
_EXCESS = 0.3  # of the rate elsewhere: less is not worth a mask
_FEWEST = 20  # events of a moment
_JOIN_US = 500
_BEFORE_US = 100  # the least width: a row's delay is known less well than that
_AFTER_US = 500  # of a row's kick: pixels that it made fire are missing among those about to


@dataclass(frozen=True)
class FrameBurst:
    """begin_us, end_us: after a frame's time. on, off: how many times the usual rate; inf where that is 0."""

    begin_us: int
    end_us: int
    on: float
    off: float


def find_bursts(subject: Subject, scan: RowScan | None) -> tuple[FrameBurst, ...]:
    """The moments to mask, in order: as narrow as the bursts are, for all rows where those take turns.

    scan: of the events at rest.
    """
    near, phase_us = subject.nearest_frame >= 0, subject.since_frame_us
    spans = _spans(subject, phase_us, [near & (subject.on == on) for on in (True, False)])
    rest = near & subject.at_rest
    spans += _spans(subject, phase_us, [rest & subject.on, rest & ~subject.on, rest])
    if scan is not None:
        last_us = round(scan.us_per_row * (subject.footage.height - 1))
        for begin, end in _spans(subject, without_delay_us(subject, scan), [rest]):
            spans.append((begin + min(last_us, 0), end + max(last_us, 0)))
    return tuple(_burst(subject, begin, end) for begin, end in joined(spans, _JOIN_US).tolist())


def exposure_windows_of(bursts: Sequence[FrameBurst], frame_t_us: NDArray[np.int64]) -> Windows:
    """The times of every burst at every frame."""
    return around(frame_t_us, joined([(burst.begin_us, burst.end_us) for burst in bursts]))


def row_mask(subject: Subject, scan: RowScan) -> Mask:
    """What to leave out of each row: no more than its own moments, as rows take turns."""
    near = subject.nearest_frame >= 0
    straight_us, frame_t_us = without_delay_us(subject, scan), subject.light.t_us
    groups = [near & subject.at_rest, near & subject.on, near & ~subject.on]
    found = [(begin - _BEFORE_US, end + _AFTER_US) for begin, end in _spans(subject, straight_us, groups)]
    spans = joined(found, _JOIN_US)
    kicked = within(straight_us, spans)
    at_once = joined(_spans(subject, subject.since_frame_us, [group & ~kicked for group in groups]), _JOIN_US)
    return Mask(around(frame_t_us, at_once), around(frame_t_us, spans), scan.us_per_row)


def _spans(
    subject: Subject, phase: NDArray[np.int64], groups: list[NDArray[np.bool_]]
) -> list[tuple[int, int]]:
    """Begin and end of the moments that have more events of one of the groups than others have."""
    half_us = round(subject.period_us / 2)
    found = np.zeros(2 * half_us, np.bool_)  # by microsecond
    place = np.clip(phase + half_us, 0, found.size - 1)
    for width_us in _WIDTHS_US:
        bins = found.size // width_us
        if bins < 8:
            continue
        bin_of_us = np.arange(found.size) * bins // found.size
        free = np.bincount(bin_of_us[~found], minlength=bins) / width_us  # what narrower windows have left
        usable = free > 0.5
        if not usable.any():
            break
        new = np.zeros(bins, np.bool_)
        for group in groups:
            fresh = group & ~found[place]
            cells = subject.nearest_frame[fresh] * bins + bin_of_us[place[fresh]]
            counts = np.bincount(cells, minlength=len(subject.light.t_us) * bins).reshape(-1, bins)
            new[usable] |= _excess(counts[:, usable] / free[usable])
        found |= new[bin_of_us]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], found, [False]]))) - half_us
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _excess(counts: NDArray[np.float64]) -> NDArray[np.bool_]:
    """counts: (frames, moments). The moments with more events than the others have."""
    frames, total = len(counts), counts.sum(0)
    usual: NDArray[np.bool_] = total <= np.quantile(total, 0.3)
    found = np.zeros_like(usual)
    for _ in range(20):
        level = counts[:, usual].mean(1)
        more = counts - level[:, None]
        variance = np.maximum(more.var(0, ddof=1), level.mean()) / frames
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.nan_to_num(more.mean(0) / np.sqrt(variance))
        found = (t > _T_TEST) & (more.mean(0) > _EXCESS * level.mean()) & (total >= _FEWEST)
        if np.array_equal(~found, usual) or found.mean() > 0.75:
            break
        usual = ~found
    return found


def _burst(subject: Subject, begin: int, end: int) -> FrameBurst:
    index, phase = subject.nearest_frame, subject.since_frame_us
    inside = (index >= 0) & (phase >= begin) & (phase < end)
    outside = (index >= 0) & ~inside
    length, rest = end - begin, subject.period_us - (end - begin)

    def ratio(on: bool) -> float:
        usual = np.count_nonzero(outside & (subject.on == on)) / max(rest, 1)
        here = np.count_nonzero(inside & (subject.on == on)) / length
        return float(here / usual) if usual else float("inf")

    return FrameBurst(begin, end, ratio(True), ratio(False))
