"""Whether frames and events are on one clock: at which lag events follow the light of the frames.

A pixel's memorised level trails ln L by up to a threshold, and after a turn nothing happens for a while; so
the events are compared not with ln L but with that level, as backlash of half a threshold gives it.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..light.grey import USUAL_DARK_DN
from .subject import Subject

_BLOCKS = (8, 16, 32)  # pixels, the smallest with which there are no more than _CELLS
_CELLS = 600_000
_EVENTS = 60_000
_FARTHEST_US = 5_000_000
_GROUPS = 8
_SURE = 6.0  # standard deviations: the highest of hundreds of lags has about 4 by chance


@dataclass(frozen=True)
class Lag:
    """events = frames + lag_us. correlation: of signed event counts and changes of ln L, by block and frame.

    score: that correlation over its standard deviation when the blocks are exchanged. reversed: the largest
    correlation, at any lag, if ON and OFF are exchanged. parts_us: the lag of each of 8 groups of blocks.
    """

    lag_us: float
    uncertainty_us: float
    correlation: float
    score: float
    reversed: float
    drift_ppm: float
    drift_uncertainty_ppm: float
    parts_us: tuple[float, ...]

    @property
    def is_sure(self) -> bool:
        """Whether the events follow the frames at all."""
        return self.score >= _SURE


def find_lag(
    subject: Subject, threshold: float | None = None, counted: NDArray[np.bool_] | None = None
) -> Lag:
    """Over +-5 s, or half the recording. Uncertainties are standard deviations: over 8 groups of blocks and,
    for the lag, with a threshold that may be 10 % off.

    threshold: of the memorised level, in ln L, by default that by which the frames give as many events; to be
    given where the events are some of those that the frames gave. counted: (frames - 1,), the intervals
    between frames that are looked at, by default all.
    """
    threshold = threshold or threshold_of(subject)
    search = _LagSearch(subject, threshold, counted)
    period_us = subject.period_us
    span_us = float(subject.light.t_us[-1] - subject.light.t_us[0])
    farthest = min(_FARTHEST_US, span_us / 2)
    coarse = np.arange(-farthest, farthest + 1, period_us / 2)
    follows = np.array([search.correlation(lag) for lag in coarse])
    near = coarse[int(np.argmax(follows))]
    lag_us = search.best(near, period_us)
    less, more = (_LagSearch(subject, threshold * by, counted).best(lag_us, period_us) for by in (0.9, 1.1))
    groups = range(_GROUPS)
    parts = np.array([search.best(lag_us, period_us, group) for group in groups])
    error_us = float(parts.std(ddof=1) / np.sqrt(_GROUPS))
    halves = [np.array([search.best(lag_us, period_us, group, half) for group in groups]) for half in (0, 1)]
    drift = (halves[1] - halves[0]) / (span_us / 2 / 1e6)
    peak = search.correlation(lag_us)
    return Lag(
        lag_us=lag_us,
        uncertainty_us=float(np.hypot(error_us, (more - less) / 2)),
        correlation=peak,
        score=peak / search.by_chance(lag_us),
        reversed=-float(follows.min()),
        drift_ppm=float(drift.mean()),
        drift_uncertainty_ppm=float(drift.std(ddof=1) / np.sqrt(_GROUPS)),
        parts_us=tuple(parts.tolist()),
    )


def threshold_of(subject: Subject) -> float:
    """The change of ln L for which the frames give as many events as there are where the light moves: twice
    those of the rarer polarity, since a leak makes only ON; from every fourth column."""
    chosen = (subject.footage.events["x"] % 4 == 0) & ~subject.at_rest & (subject.interval >= 0)
    moving, on = np.count_nonzero(chosen), np.count_nonzero(chosen & subject.on)
    count = max(1.0, 2.0 * min(on, moving - on))
    levels = np.log(subject.footage.frames[..., ::4].astype(np.float32) + USUAL_DARK_DN)
    low, high = 0.01, 3.0
    for _ in range(9):
        middle = float(np.sqrt(low * high))
        total = sum(float(np.abs(step).sum()) for step in memorised(levels, middle / 2))
        low, high = (middle, high) if total / middle > count else (low, middle)
    return float(np.sqrt(low * high))


def memorised(levels: Iterable[NDArray[np.float32]], slack: float) -> Iterator[NDArray[np.float32]]:
    """Changes of a level that follows (H, W) images with a backlash of +-slack, one fewer than images."""
    memory: NDArray[np.float32] | None = None
    for level in levels:
        if memory is None:
            memory = level
            continue
        moved = np.clip(memory, level - slack, level + slack)
        yield moved - memory
        memory = moved


class _LagSearch:
    """Correlations at any lag, of some of the events, so that each takes a millisecond or few."""

    def __init__(self, subject: Subject, threshold: float, counted: NDArray[np.bool_] | None) -> None:
        light, events = subject.light, subject.footage.events
        chosen = events[:: max(1, events.size // _EVENTS)]
        chosen = chosen[np.argsort(chosen["t"], kind="stable")]
        self._t = chosen["t"].astype(np.float64)
        self._sign = np.where(chosen["p"], 1.0, -1.0)
        height, width = subject.footage.height, subject.footage.width
        pixels = len(light.step) * height * width
        side = next((side for side in _BLOCKS if pixels <= _CELLS * side**2), _BLOCKS[-1])
        rows, columns = -(-height // side), -(-width // side)
        self._blocks = rows * columns
        self._block = (chosen["y"] // side).astype(np.int64) * columns + chosen["x"] // side
        self._frame_t = light.t_us.astype(np.float64)
        self._change = np.zeros((len(light.step), self._blocks))
        images = subject.footage.frames
        levels = (np.log(image.astype(np.float32) + USUAL_DARK_DN) for image in images)
        for row, step in zip(self._change, memorised(levels, threshold / 2), strict=True):
            padded = np.zeros((rows * side, columns * side), np.float32)
            padded[: step.shape[0], : step.shape[1]] = step
            row[:] = padded.reshape(rows, side, columns, side).sum((1, 3)).ravel()
        self._group = np.arange(self._blocks) % _GROUPS
        self._counted = np.ones(len(self._change), np.bool_) if counted is None else counted
        self._counted_change = self._change[self._counted]

    def correlation(self, lag_us: float, group: int | None = None, half: int | None = None) -> float:
        """Of the events of each interval, shifted by the lag, with its change; 0 where there is none."""
        events, change = self._events(lag_us), self._counted_change
        if half is not None:
            middle = len(change) // 2
            part = slice(middle) if half == 0 else slice(middle, None)
            events, change = events[part], change[part]
        if group is not None:
            events, change = events[:, self._group == group], change[:, self._group == group]
        norm = np.sqrt(np.sum(events**2) * np.sum(change**2))
        return float(np.sum(events * change) / norm) if norm else 0.0

    def by_chance(self, lag_us: float) -> float:
        """The standard deviation of the correlation of blocks with other blocks' light."""
        events, rng = self._events(lag_us), np.random.default_rng(0)
        change = self._counted_change
        norm = max(float(np.sqrt(np.sum(events**2) * np.sum(change**2))), 1e-9)
        others = [np.sum(events[:, rng.permutation(self._blocks)] * change) / norm for _ in range(32)]
        return max(float(np.std(others)), 1e-9)

    def _events(self, lag_us: float) -> NDArray[np.float64]:
        """(counted intervals, blocks): ON less OFF."""
        first = np.searchsorted(self._t, self._frame_t + lag_us)  # of each frame's interval
        inside = slice(first[0], first[-1])
        cells = np.repeat(self._blocks * np.arange(len(self._change)), np.diff(first)) + self._block[inside]
        signed = np.bincount(cells, self._sign[inside], self._change.size)
        return signed.astype(np.float64).reshape(self._change.shape)[self._counted]

    def best(
        self, near_us: float, period_us: float, group: int | None = None, half: int | None = None
    ) -> float:
        """The lag of the largest correlation within a period of `near_us`: a parabola through the top."""
        lags = near_us + period_us * np.linspace(-1, 1, 25)
        scores = np.array([self.correlation(lag, group, half) for lag in lags])
        top = scores >= scores.max() - 0.15 * (scores.max() - scores.min())
        if np.count_nonzero(top) < 3:
            return float(lags[int(np.argmax(scores))])
        a, b, _ = np.polyfit(lags[top] - near_us, scores[top], 2)
        vertex = float(-b / (2 * a)) if a < 0 else np.inf
        return near_us + vertex if abs(vertex) <= period_us else float(lags[int(np.argmax(scores))])
