"""What the light did where an event was: brightness, change, and where it stood still."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .grey import USUAL_DARK_DN
from .still import still_pairs

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FrameLight:
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

    def change(self, t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]) -> Array:
        """d ln L / dt [1/s] between the frames before and after."""
        before, after = self._around(t_us, x, y)
        span_s = np.diff(self.t_us)[self.interval_of(t_us)] / 1e6
        change: Array = np.log((after + USUAL_DARK_DN) / (before + USUAL_DARK_DN)) / span_s
        return change

    def speed(self, t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]) -> Array:
        """|d ln L / dt| [1/s] between the frames before and after."""
        return np.abs(self.change(t_us, x, y))

    def _around(
        self, t_us: NDArray[np.int64], x: NDArray[np.uint16], y: NDArray[np.uint16]
    ) -> tuple[Array, Array]:
        number = self.interval_of(t_us)
        before, after = self.images[number, y, x], self.images[number + 1, y, x]
        return before.astype(np.float64), after.astype(np.float64)

    @cached_property
    def still(self) -> NDArray[np.bool_]:
        """(N - 1, H, W): as `light.still.still_pairs`."""
        return still_pairs(self.images, self.t_us)
