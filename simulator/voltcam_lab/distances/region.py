"""Which pixels and which times are compared, and the halves of them that give a recording's own floor."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ..windows import Windows, common, complement, joined, no_windows, number_of, overlap_us, total_us, within

Pixels = NDArray[np.bool_]

TILE_PIXELS = 24  # of what is held out: 2 x 2 patches of the classifier, 6 x 6 blocks of counts
BLOCK_US = 100_000  # of the floor by time
HELD_OUT_US = 400_000  # longer than most intervals between events, which do not go across


@dataclass(frozen=True, eq=False)
class Region:
    """pixels: (H, W) bool. times: (M, 2) int64 [us], begin and end of each stretch [begin, end), in order and
    apart; no interval goes across the end of one. hidden: (K, 2), windows whose events are left out, as
    around exposures; an interval may go across these, or none would be longer than a frame period."""

    pixels: Pixels
    times: Windows
    hidden: Windows = field(default_factory=no_windows)

    @classmethod
    def whole(cls, width: int, height: int, begin_us: int, end_us: int) -> Self:
        """All pixels, from begin_us until before end_us."""
        return cls(np.ones((height, width), bool), np.array([[begin_us, end_us]], np.int64))

    def on(self, pixels: Pixels) -> Self:
        """Only where `pixels` (H, W) is true."""
        return replace(self, pixels=self.pixels & pixels)

    def during(self, times: Windows) -> Self:
        """Only while both this and `times` (M, 2) last; the result keeps the ends of both."""
        return replace(self, times=common(self.times, times))

    def without(self, windows: Windows) -> Self:
        """Less the events in windows (K, 2), which may overlap."""
        return replace(self, hidden=joined(np.concatenate([self.hidden, windows])))

    @cached_property
    def live(self) -> Windows:
        """`times` less what is hidden."""
        return common(self.times, complement(self.hidden))

    def outside(self) -> Windows:
        """(N, 2) [us]: all time that is not live, hidden or not in `times`."""
        return complement(self.live)

    @property
    def pixel_seconds(self) -> float:
        """Pixels times live seconds: what a rate is counted over."""
        return float(np.count_nonzero(self.pixels)) * float(total_us(self.live)) / 1e6

    def of(self, events: Events) -> Events:
        """The events in here."""
        inside = self.pixels[events["y"], events["x"]] & within(events["t"], self.live)
        chosen: Events = events[inside]
        return chosen

    def stretch_of(self, t_us: NDArray[np.int64]) -> NDArray[np.int64]:
        """For each time the number of its stretch, -1 outside all of them."""
        return number_of(t_us, self.times)

    def live_in(self, edges_us: NDArray[np.int64]) -> NDArray[np.float64]:
        """Live time [us] between each two edges (N,), ascending: (N - 1,)."""
        return overlap_us(self.live, edges_us)


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
