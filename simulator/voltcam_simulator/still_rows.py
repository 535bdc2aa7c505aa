"""Which rows are under still light, and what is done with them instead of looking at every pixel."""

import numpy as np

from .band_state import Image, Rows
from .effect import Plane
from .random import AHEAD, BACK, interval_key
from .waiting_times import PATIENCE, catch_up, count_quiet, draw_ahead, draw_due, find_due, shift_epoch

LONGEST_US = 2.0**23
"""Longest step, and longest time since the epoch: float32 counts whole microseconds up to twice that."""


class StillRows:
    """The rows of a sensor that are drawn ahead, how long each has been unchanged, and the planes for that.

    since: (height * width,) plane of the sensor that rows ahead need for nothing else.
    """

    def __init__(self, width: int, height: int, seed: int, since: Plane) -> None:
        self._width, self._seed, self._since = width, seed, since
        self.allowed = False  # by the effects that are on
        self.quiet, self.ahead = np.zeros(height, np.int32), np.zeros(height, np.bool_)
        self.begun = np.zeros(height, np.float32)
        self.due, self.motion = np.zeros(since.size, np.float32), np.zeros((since.size, 2), np.float32)
        self._changed, self._most_quiet = height, 0  # how many rows change in a step, and most of `quiet`
        self.now_us, self.steps = 0.0, 0  # now_us: since the epoch

    def restore(self, steps: int, now_us: float) -> None:
        """Be as after `wake_all`, so many steps after the beginning."""
        self.quiet[:], self._changed, self._most_quiet = 0, self.quiet.size, 0
        self.ahead[:] = False
        self.steps, self.now_us = steps, now_us

    @property
    def nbytes(self) -> int:
        """Memory of the planes."""
        return self.due.nbytes + self.motion.nbytes

    def look(self, before: Image, after: Image, span_us: float) -> None:
        """Note which rows change over a step of span_us."""
        if before.dtype == after.dtype and span_us <= LONGEST_US:
            self._changed, self._most_quiet = count_quiet(
                before.view(np.uint8), after.view(np.uint8), self.quiet
            )
        else:
            self.quiet[:], self._changed, self._most_quiet = 0, self.quiet.size, 0

    def wake(self, rows: Rows) -> None:
        """Bring those rows of a band that are ahead, but change in this step, to its start."""
        if self._changed:
            key = interval_key(self._seed, BACK, self.steps)
            rows.rows_ahead -= catch_up(
                rows.quiet, rows.ahead, rows.begun, rows.voltage, rows.pending, rows.due, rows.motion,
                rows.above, rows.below, key, rows.pixels.start, self.now_us,
            )  # fmt: skip

    def wake_all(self, bands: list[Rows]) -> None:
        """Bring all rows to the present: something else than the light changes."""
        self.quiet[:], self._changed, self._most_quiet = 0, self.quiet.size, 0
        for rows in bands:
            self.wake(rows)

    def forget(self, bands: list[Rows]) -> None:
        """Take all rows as they were when they were drawn ahead: what was drawn since is lost."""
        self.quiet[:], self._changed, self._most_quiet = 0, self.quiet.size, 0
        self._since.reshape(-1, self._width)[self.ahead] = 0
        self.ahead[:] = False
        for rows in bands:
            rows.rows_ahead = 0

    def draw_due(self, rows: Rows, key: np.uint64, span_us: float, offset_us: float) -> None:
        """The events of a band's rows that are ahead, over a step that starts offset_us into its interval."""
        found = rows.room.near
        count = find_due(rows.ahead, rows.due, np.float32(self.now_us + span_us), found)
        rows.room.draw(count, lambda done, keys: draw_due(
            rows.pending, rows.due, rows.motion, rows.above, rows.below, found, done, count,
            self.now_us, span_us, offset_us, key, rows.pixels.start, self._width, keys,
        ))  # fmt: skip

    def draw_ahead(self, rows: Rows, span_us: float) -> None:
        """At the end of a step, draw those rows of a band ahead that have been unchanged for long enough."""
        if self._most_quiet >= PATIENCE:
            key = interval_key(self._seed, AHEAD, self.steps)
            rows.rows_ahead += draw_ahead(
                rows.quiet, rows.ahead, rows.begun, rows.voltage, rows.pending, rows.due, rows.motion,
                rows.band.drift, rows.band.noise, span_us, rows.above, rows.below, key, rows.pixels.start,
                self.now_us + span_us,
            )  # fmt: skip

    def pass_by(self, span_us: float) -> None:
        """A step is over."""
        self.steps += 1
        self.now_us += span_us
        if self.now_us > LONGEST_US:
            shift_epoch(self.ahead, self.begun, self._since, self.due, np.float32(self.now_us))
            self.now_us = 0.0
