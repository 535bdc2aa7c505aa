"""Which pixels and which times are compared, and the halves of them that give a recording's own floor."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

Pixels = NDArray[np.bool_]
Times = NDArray[np.int64]

TILE_PIXELS = 24  # of what is held out: 2 x 2 patches of the classifier, 6 x 6 blocks of counts
BLOCK_US = 100_000  # of the floor by time
HELD_OUT_US = 400_000  # longer than most intervals between events, which do not go across


@dataclass(frozen=True, eq=False)
class Region:
    """pixels: (H, W) bool. times: (M, 2) int64 [us], begin and end of each stretch [begin, end), in order and
    apart; no interval goes across the end of one. hidden: (K, 2), windows whose events are left out, as
    around exposures; an interval may go across these, or none would be longer than a frame period."""

    pixels: Pixels
    times: Times
    hidden: Times = field(default_factory=lambda: np.empty((0, 2), np.int64))

    @classmethod
    def whole(cls, width: int, height: int, begin_us: int, end_us: int) -> Self:
        """All pixels, from begin_us until before end_us."""
        return cls(np.ones((height, width), bool), np.array([[begin_us, end_us]], np.int64))

    def on(self, pixels: Pixels) -> Self:
        """Only where `pixels` (H, W) is true."""
        return replace(self, pixels=self.pixels & pixels)

    def during(self, times: Times) -> Self:
        """Only while both this and `times` (M, 2) last; the result keeps the ends of both."""
        return replace(self, times=_common(self.times, times))

    def without(self, windows: Times) -> Self:
        """Less the events in windows (K, 2), which may overlap."""
        return replace(self, hidden=_joined(np.concatenate([self.hidden, windows])))

    @cached_property
    def live(self) -> Times:
        """`times` less what is hidden."""
        return _common(self.times, _gaps(self.hidden))

    def outside(self) -> Times:
        """(N, 2) [us]: all time that is not live, hidden or not in `times`."""
        return _gaps(self.live)

    @property
    def pixel_seconds(self) -> float:
        """Pixels times live seconds: what a rate is counted over."""
        return float(np.count_nonzero(self.pixels)) * float(np.sum(np.diff(self.live))) / 1e6

    def of(self, events: Events) -> Events:
        """The events in here."""
        inside = self.pixels[events["y"], events["x"]] & (_stretch(self.live, events["t"]) >= 0)
        chosen: Events = events[inside]
        return chosen

    def stretch_of(self, t_us: Times) -> NDArray[np.int64]:
        """For each time the number of its stretch, -1 outside all of them."""
        return _stretch(self.times, t_us)

    def live_in(self, edges_us: Times) -> NDArray[np.float64]:
        """Live time [us] between each two edges (N,), ascending: (N - 1,)."""
        gathered = np.sum(np.clip(edges_us - self.live[:, :1], 0, np.diff(self.live)), axis=0)
        spans: NDArray[np.float64] = np.diff(gathered).astype(np.float64)
        return spans


def _stretch(times: Times, t_us: Times) -> NDArray[np.int64]:
    number = np.searchsorted(times[:, 0], t_us, side="right") - 1
    inside = number >= 0
    inside[inside] = t_us[inside] < times[number[inside], 1]
    return np.where(inside, number, -1)


def _common(first: Times, second: Times) -> Times:
    """What two lists of stretches have in common, cut at the ends of both."""
    pieces = [
        (max(begin, a), min(end, b))
        for begin, end in first.tolist()
        for a, b in second.tolist()
        if max(begin, a) < min(end, b)
    ]
    return np.array(sorted(pieces), np.int64).reshape(-1, 2)


def _joined(windows: Times) -> Times:
    """In order and apart."""
    result: list[list[int]] = []
    for begin, end in sorted(windows.tolist()):
        if result and begin <= result[-1][1]:
            result[-1][1] = max(result[-1][1], end)
        else:
            result.append([begin, end])
    return np.array(result, np.int64).reshape(-1, 2)


def _gaps(windows: Times) -> Times:
    """All time before, between and after windows that are in order and apart."""
    ends = np.iinfo(np.int64)
    edges = np.concatenate([[ends.min], windows.ravel(), [ends.max]])
    return edges.reshape(-1, 2)


Halves = tuple[Region, Region]


def by_pixels(region: Region, tile: int) -> Halves:
    """The black and the white fields of a checkerboard of tile x tile pixels."""
    y, x = np.indices(region.pixels.shape)
    white = (x // tile + y // tile) % 2 == 1
    return region.on(~white), region.on(white)


def by_time(region: Region, block_us: int) -> Halves:
    """The even and the odd ones of blocks of time."""
    if not len(region.times):
        return region, region
    begin, end = int(region.times[0, 0]), int(region.times[-1, 1])
    starts = np.arange(begin, end, block_us)
    blocks = np.column_stack([starts, starts + block_us])
    return region.during(blocks[::2]), region.during(blocks[1::2])


def held_out(region: Region, tile: int = TILE_PIXELS, block_us: int = HELD_OUT_US) -> Halves:
    """(what to fit on, what to judge by): they share neither a pixel nor a time."""
    own, other = by_pixels(region, tile)
    return by_time(own, block_us)[0], by_time(other, block_us)[1]
