"""What one thread works with: scratch planes, and space for event keys that grows."""

import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .limits import Limits, TooManyEventsError

Keys = NDArray[np.uint64]

FIRST_KEYS = 8192
"""Space for events before any has come."""
MOST_KEYS_MORE = 1 << 20
"""What that space grows by at once, at most."""


class Workspace:
    """Of one thread, for one band of at most so many pixels at a time."""

    def __init__(self, pixels: int) -> None:
        self.planes = np.empty((6, pixels), np.float32)
        self.zeros = np.zeros(pixels, np.float32)  # for pixels without dead times, without kicks
        self.near, self.bent = np.empty((2, pixels + 1), np.int32)  # numbers of pixels that a kernel found
        self._keys = np.empty(FIRST_KEYS, np.uint64)
        self._filled = 0
        self.most_keys, self.limits = sys.maxsize, Limits()  # of one interval

    def draw(self, count: int, draw: Callable[[int, Keys], tuple[int, int]]) -> None:
        """Let draw(pixels done, space) -> (pixels done, keys written) go on until count pixels are done."""
        done = 0
        while done < count:
            done, written = draw(done, self._keys[self._filled :])
            self._filled += written
            if done < count:
                self.limits.hurry()
                self._grow()

    def _grow(self) -> None:
        size = self._keys.size
        if size >= self.most_keys:
            raise TooManyEventsError
        more = min(size, MOST_KEYS_MORE, self.most_keys - size)
        self._keys = np.concatenate([self._keys, np.empty(more, np.uint64)])

    def take_keys(self) -> Keys:
        """The keys drawn since the last call; good until the next draw."""
        keys, self._filled = self._keys[: self._filled], 0
        return keys

    def forget_keys(self) -> None:
        """Drop what has been drawn, and the space for it."""
        self._keys, self._filled = np.empty(FIRST_KEYS, np.uint64), 0

    @property
    def nbytes(self) -> int:
        """Memory of the scratch planes, without the events."""
        return self.planes.nbytes + self.zeros.nbytes + self.near.nbytes + self.bent.nbytes

    @property
    def event_bytes(self) -> int:
        """Memory of the space for event keys."""
        return self._keys.nbytes
