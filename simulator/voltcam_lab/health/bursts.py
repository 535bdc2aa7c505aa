"""Events that come with the camera's frames: the moments around a frame to mask.

A moment is one with more events than other moments of the same frames have, or fewer: by a t test over the
frames, so that a scene's own bursts do not count, at several widths, for ON and OFF, for pixels at rest and
others. |t| above 5 in about 2000 tests: less than 1 % to find one where there is none.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..windows import Mask, Windows, around, joined, within
from .row_scan import RowScan, without_delay_us
from .subject import Subject

_WIDTHS_US = (100, 400, 1600, 5000)
_T_TEST = 5.0
_EXCESS = 0.3  # of the rate elsewhere, more or less: what differs by less is not worth a mask
_FEWEST = 20  # events of a moment
_MOST = 0.75  # of the period: where more of it is unusual, nothing is usual
_JOIN_US = 500
_BESIDE_US = 100  # the least width: a row's delay is known less well than that


class Moments(NamedTuple):
    """(K, 2) [us after a frame's time] each, in order."""

    more: Windows
    fewer: Windows


@dataclass(frozen=True)
class FrameBurst:
    """begin_us, end_us: after a frame's time. on, off: how many times the usual rate; inf where that is 0."""

    begin_us: int
    end_us: int
    on: float
    off: float


def find_moments(subject: Subject, scan: RowScan | None) -> Moments:
    """Moments with more events, and with fewer: as narrow as they are, for all rows where those take turns.

    scan: of the events at rest.
    """
    near, phase_us = subject.nearest_frame >= 0, subject.since_frame_us
    rest = near & subject.at_rest
    groups = [near & subject.on, near & ~subject.on]
    parts = [_moments(subject, phase_us, groups)]
    parts.append(_moments(subject, phase_us, [rest & subject.on, rest & ~subject.on, rest]))
    if scan is not None:
        last_us = round(scan.us_per_row * (subject.footage.height - 1))
        reach = np.array([min(last_us, 0), max(last_us, 0)])
        own = _moments(subject, without_delay_us(subject, scan), [rest])
        parts.append(Moments(*(spans + reach for spans in own)))
    return Moments(*(joined(np.concatenate(spans), _JOIN_US) for spans in zip(*parts, strict=True)))


def bursts_of(subject: Subject, moments: Moments) -> tuple[FrameBurst, ...]:
    """Those with more events, in order."""
    return tuple(_burst(subject, begin, end) for begin, end in moments.more.tolist())


def windows_of(moments: Moments, frame_t_us: NDArray[np.int64]) -> Windows:
    """The times of every moment at every frame."""
    return around(frame_t_us, joined(np.concatenate(moments), _JOIN_US))


def row_mask(subject: Subject, scan: RowScan) -> Mask:
    """What to leave out of each row: no more than its own moments, as rows take turns."""
    near = subject.nearest_frame >= 0
    straight_us, frame_t_us = without_delay_us(subject, scan), subject.light.t_us
    groups = [near & subject.at_rest, near & subject.on, near & ~subject.on]
    found = np.concatenate(_moments(subject, straight_us, groups))
    spans = joined(found + np.array([-_BESIDE_US, _BESIDE_US]), _JOIN_US)
    kicked = within(straight_us, spans)
    others = [group & ~kicked for group in groups]
    left = np.array([_left(subject, scan, spans, group) for group in others])
    # The scene moves over the rows, so that fewer events mean little where some rows are missing.
    at_once, _ = _moments(subject, subject.since_frame_us, others, left)
    return Mask(around(frame_t_us, joined(at_once, _JOIN_US)), around(frame_t_us, spans), scan.us_per_row)


def _left(subject: Subject, scan: RowScan, spans: Windows, others: NDArray[np.bool_]) -> NDArray[np.float64]:
    """The share of the events outside their rows' own spans that can be there, by microsecond of the period.

    Rows count by their events: those of an empty sky are not missed.
    """
    half_us, height = round(subject.period_us / 2), subject.footage.height
    delays_us = np.rint(scan.us_per_row * np.arange(height)).astype(np.int64)
    events = np.bincount(subject.y[others], minlength=height)
    share = events / max(events.sum(), 1)
    taken = np.zeros(2 * half_us)
    for begin, end in spans.tolist():
        span = np.arange(begin, end) + half_us
        np.add.at(taken, (span + delays_us[:, None]) % taken.size, share[:, None])
    return 1 - np.minimum(taken, 1)


def _moments(
    subject: Subject, phase: NDArray[np.int64], groups: list[NDArray[np.bool_]],
    left: NDArray[np.float64] | None = None,
) -> Moments:  # fmt: skip
    """The moments that have more events of one of the groups than others have, and those that have fewer.

    left: (groups, period_us), the share of each group's events that can be there at all; None: all.
    """
    half_us = round(subject.period_us / 2)
    left = np.ones((len(groups), 2 * half_us)) if left is None else left
    found = np.zeros(2 * half_us, np.int8)  # by microsecond: 1 more, -1 fewer
    place = np.clip(phase + half_us, 0, found.size - 1)
    for width_us in _WIDTHS_US:
        bins = found.size // width_us
        if bins < 8:
            continue
        bin_of_us = np.arange(found.size) * bins // found.size
        new = np.zeros(bins, np.int8)
        for group, its_left in zip(groups, left, strict=True):
            # Less what narrower moments have.
            free = np.bincount(bin_of_us, (found == 0) * its_left, bins) / width_us
            usable = free > 0.5
            if not usable.any():
                continue
            fresh = group & (found[place] == 0)
            cells = subject.nearest_frame[fresh] * bins + bin_of_us[place[fresh]]
            counts = np.bincount(cells, minlength=len(subject.light.t_us) * bins).reshape(-1, bins)
            unusual = _unusual(counts[:, usable] / free[usable])
            new[usable] = np.where(new[usable] > 0, 1, np.where(unusual != 0, unusual, new[usable]))
        found = np.where(found == 0, new[bin_of_us], found)
    return Moments(*(_spans_of(found == sign) - half_us for sign in (1, -1)))


def _spans_of(inside: NDArray[np.bool_]) -> Windows:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]])))
    return edges.reshape(-1, 2).astype(np.int64)


def _unusual(counts: NDArray[np.float64]) -> NDArray[np.int8]:
    """counts: (frames, moments). 1 for moments with more events than others have, -1 with fewer, 0 the rest.

    A kick takes pixels to their thresholds sooner, so that a lull follows its burst. What is usual is
    therefore told by the half of the period before the fullest moment.
    """
    frames, total = len(counts), counts.sum(0)
    before = np.roll(np.arange(total.size) < total.size // 2, int(total.argmax()) - total.size // 2)
    usual: NDArray[np.bool_] = before & (total <= np.quantile(total[before], 0.3))
    found = np.zeros(total.size, np.int8)
    for _ in range(20):
        level = counts[:, usual].mean(1)
        more = counts - level[:, None]
        variance = np.maximum(more.var(0, ddof=1), level.mean()) / frames
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.nan_to_num(more.mean(0) / np.sqrt(variance))
        much = (np.abs(more.mean(0)) > _EXCESS * level.mean()) & (np.maximum(total, level.sum()) >= _FEWEST)
        found = np.where((np.abs(t) > _T_TEST) & much, np.sign(t), 0).astype(np.int8)
        still = before & (found == 0)
        if np.count_nonzero(found) > _MOST * found.size:
            return np.zeros_like(found)
        if np.array_equal(still, usual):
            break
        usual = still
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
