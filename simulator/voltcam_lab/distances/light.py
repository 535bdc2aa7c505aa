"""What the light did where an event was: brightness, change, and where it stood still."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .region import Region

Array = NDArray[np.float64]

DARK_DN = 20.0
"""Added to the grey level before the logarithm, as k2 in the paper: grey levels near 0 are mostly noise."""
STILL_LOG = 0.12
"""Light that varies by less than this (in ln) over STILL_US stands still; frame noise alone reaches .1."""
STILL_US = 200_000
NEIGHBOURS = 5


@dataclass(frozen=True, eq=False)
class Light:
    """images: (N, H, W) grey levels [DN] as recorded; t_us: (N,) int64, ascending. N is at least 2."""

    images: NDArray[np.uint8]
    t_us: NDArray[np.int64]

    def interval_of(self, t_us: NDArray[np.int64]) -> NDArray[np.int64]:
        """The number of the frame before; times outside belong to the first or the last interval."""
        number = np.searchsorted(self.t_us, t_us, side="right") - 1
        return np.clip(number, 0, len(self.t_us) - 2)

    def brightness(self, t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]) -> Array:
        """Mean of the frames before and after [DN]."""
        before, after = self._around(t_us, x, y)
        return (before + after) / 2

    def speed(self, t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]) -> Array:
        """|d ln L / dt| [1/s] between the frames before and after."""
        before, after = self._around(t_us, x, y)
        span_s = np.diff(self.t_us)[self.interval_of(t_us)] / 1e6
        change: Array = np.abs(np.log((after + DARK_DN) / (before + DARK_DN))) / span_s
        return change

    def _around(
        self, t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]
    ) -> tuple[Array, Array]:
        number = self.interval_of(t_us)
        before, after = self.images[number, y, x], self.images[number + 1, y, x]
        return before.astype(np.float64), after.astype(np.float64)

    @cached_property
    def still(self) -> NDArray[np.bool_]:
        """(N - 1, H, W): between these two frames, and STILL_US around, light changed neither here nor next
        to here."""
        log = np.stack(
            [np.log(ndimage.gaussian_filter(i.astype(np.float32), 1) + DARK_DN) for i in self.images]
        )
        first = np.searchsorted(self.t_us, self.t_us[:-1] - STILL_US // 2)
        last = np.searchsorted(self.t_us, self.t_us[1:] + STILL_US // 2, side="right")
        planes = []
        for begin, end in zip(first, last, strict=True):
            span = np.ptp(log[begin:end], axis=0)
            planes.append(ndimage.maximum_filter(span, NEIGHBOURS) < STILL_LOG)
        return np.stack(planes)

    def still_seconds(self, region: Region) -> Array:
        """(N - 1,): between each two frames, pixels of the region in still light times live seconds."""
        pixels = np.count_nonzero(self.still & region.pixels, axis=(1, 2))
        seconds: Array = pixels * region.live_in(self.t_us) / 1e6
        return seconds
