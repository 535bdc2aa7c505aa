"""Events that come with the camera's frames: the moments around a frame to mask, and whether rows take turns.

A moment is one with more events than other moments of the same frames have: by a t test over the frames, so
that a scene's own bursts do not count, at several widths, for ON and OFF, for pixels at rest and others.
t above 5 in about 2000 tests: less than 1 % to find one where there is none.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_lab.health.subject import Subject
from voltcam_lab.windows import Mask

_WIDTHS_US = (100, 400, 1600, 5000)
_T_TEST = 5.0
_EXCESS = 0.3  # of the rate elsewhere: less is not worth a mask
_FEWEST = 20  # events of a moment
_JOIN_US = 500
_BEFORE_US = 100  # the least width: a row's delay is known less well than that
_AFTER_US = 500  # of a row's kick: pixels that it made fire are missing among those about to
_SHUFFLES = 19


@dataclass(frozen=True)
class Window:
    """begin_us, end_us: after a frame's time. on, off: how many times the usual rate; inf where that is 0."""

    begin_us: int
    end_us: int
    on: float
    off: float


@dataclass(frozen=True)
class RowScan:
    """Rows follow one another every us_per_row (negative: upwards)."""

    us_per_row: float
    score: float


def phases(subject: Subject) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The frame nearest to each event, and the event's time after it; index -1 if half a period away."""
    frames = subject.light.t_us
    after = np.clip(np.searchsorted(frames, subject.t_us), 1, len(frames) - 1)
    nearer_before = subject.t_us - frames[after - 1] < frames[after] - subject.t_us
    index = np.where(nearer_before, after - 1, after)
    phase = subject.t_us - frames[index]
    return np.where(np.abs(phase) < subject.period_us / 2, index, -1), phase


def find_windows(subject: Subject) -> list[Window]:
    """The moments to mask, in order: as narrow as the bursts are, for all rows where those take turns."""
    index, phase = phases(subject)
    near = index >= 0
    spans = _spans(subject, index, phase, [near & (subject.on == on) for on in (True, False)])
    rest = near & subject.at_rest
    spans += _spans(subject, index, phase, [rest & subject.on, rest & ~subject.on, rest])
    scan = find_row_scan(subject, rest)
    if scan is not None:
        last_us = round(scan.us_per_row * (subject.recording.height - 1))
        for begin, end in _spans(subject, index, _straight(subject, phase, scan), [rest]):
            spans.append((begin + min(last_us, 0), end + max(last_us, 0)))
    return [_window(subject, index, phase, begin, end) for begin, end in _joined(spans)]


def find_mask(subject: Subject) -> Mask:
    """What to leave out of each row: no more than its own moments where rows take turns."""
    index, phase = phases(subject)
    near, frame_t_us = index >= 0, subject.light.t_us
    rest = near & subject.at_rest
    scan = find_row_scan(subject, rest)
    if scan is None:
        return Mask(mask_of(find_windows(subject), frame_t_us))
    straight = _straight(subject, phase, scan)
    groups = [rest, near & subject.on, near & ~subject.on]
    spans = _spans(subject, index, straight, groups)
    spans = _joined([(begin - _BEFORE_US, end + _AFTER_US) for begin, end in spans])
    kicked = np.zeros(phase.size, np.bool_)
    for begin, end in spans:
        kicked |= (straight >= begin) & (straight < end)
    at_once = _joined(_spans(subject, index, phase, [group & ~kicked for group in groups]))
    return Mask(spans_at(at_once, frame_t_us), spans_at(spans, frame_t_us), scan.us_per_row)


def _straight(subject: Subject, phase: NDArray[np.int64], scan: RowScan) -> NDArray[np.int64]:
    """Phases without the rows' delay: the bursts are narrow and stand out."""
    half_us = subject.period_us / 2
    straight = (phase - scan.us_per_row * subject.y + half_us) % (2 * half_us) - half_us
    return straight.astype(np.int64)


def _spans(
    subject: Subject, index: NDArray[np.int64], phase: NDArray[np.int64], groups: list[NDArray[np.bool_]]
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
            cells = index[fresh] * bins + bin_of_us[place[fresh]]
            counts = np.bincount(cells, minlength=len(subject.light.t_us) * bins).reshape(-1, bins)
            new[usable] |= _excess(counts[:, usable] / free[usable])
        found |= new[bin_of_us]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], found, [False]]))) - half_us
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def mask_of(windows: list[Window], frame_t_us: NDArray[np.int64]) -> NDArray[np.int64]:
    """(M, 2) begin and end of every window at every frame, sorted, joined where they overlap."""
    return spans_at([(window.begin_us, window.end_us) for window in windows], frame_t_us)


def spans_at(spans: Sequence[tuple[int, int]], frame_t_us: NDArray[np.int64]) -> NDArray[np.int64]:
    """The same of spans [us] about the frames' times."""
    begins, ends = np.array(spans, np.int64).reshape(-1, 2).T
    pairs = zip(
        (frame_t_us[:, None] + begins).ravel().tolist(),
        (frame_t_us[:, None] + ends).ravel().tolist(),
        strict=True,
    )
    return np.array(_joined(list(pairs), gap=0), np.int64).reshape(-1, 2)


def find_row_scan(subject: Subject, chosen: NDArray[np.bool_]) -> RowScan | None:
    """How the chosen events run over the rows after each frame, if they do: the slope that makes their times
    after the frame fall together best, against the same events with their rows exchanged."""
    index, phase = phases(subject)
    events = np.flatnonzero(chosen & (index >= 0))
    events = events[:: max(1, events.size // 5000)]
    if events.size < 200:
        return None
    t, y = phase[events].astype(np.float64), subject.y[events].astype(np.float64)
    period_us, rows = subject.period_us, subject.recording.height
    steepest = 1.1 * period_us / rows
    slopes = np.arange(-steepest, steepest, 250 / rows)

    def gathered(y: NDArray[np.float64], slopes: NDArray[np.float64], width_us: float) -> NDArray[np.float64]:
        bins = int(period_us // width_us)
        places = ((t - slopes[:, None] * y) % period_us * bins / period_us).astype(np.int64) % bins
        return np.array([np.sum(np.bincount(place, minlength=bins) ** 2.0) for place in places], np.float64)

    scores = gathered(y, slopes, 250)
    rng = np.random.default_rng(0)
    null = np.array([gathered(rng.permutation(y), slopes, 250).max() for _ in range(_SHUFFLES)])
    score = float((scores.max() - null.mean()) / max(null.std(ddof=1), 1e-9))
    if score < 6:
        return None
    fine = slopes[int(np.argmax(scores))] + np.linspace(-1, 1, 81) * 500 / rows
    slope = float(fine[int(np.argmax(gathered(y, fine, 100)))])
    return RowScan(slope, score) if abs(slope) * rows > 500 else None


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


def _joined(spans: Sequence[tuple[float, float]], gap: float = _JOIN_US) -> list[tuple[int, int]]:
    joined: list[tuple[int, int]] = []
    for begin, end in sorted((round(begin), round(end)) for begin, end in spans):
        if joined and begin <= joined[-1][1] + gap:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((begin, end))
    return joined


def _window(
    subject: Subject, index: NDArray[np.int64], phase: NDArray[np.int64], begin: int, end: int
) -> Window:
    inside = (index >= 0) & (phase >= begin) & (phase < end)
    outside = (index >= 0) & ~inside
    length, rest = end - begin, subject.period_us - (end - begin)

    def ratio(on: bool) -> float:
        usual = np.count_nonzero(outside & (subject.on == on)) / max(rest, 1)
        here = np.count_nonzero(inside & (subject.on == on)) / length
        return float(here / usual) if usual else float("inf")

    return Window(begin, end, ratio(True), ratio(False))
