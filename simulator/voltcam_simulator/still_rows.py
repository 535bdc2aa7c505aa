"""Which rows are under still light, and what is done with them instead of looking at every pixel."""

import numpy as np

from .band_state import BandState
from .effect import Image, Plane
from .groups import AheadRows, Step
from .random import AHEAD, BACK, interval_key
from .waiting_times import (
    STILL_STEPS,
    catch_up,
    count_still_steps,
    draw_ahead,
    draw_due,
    find_due,
    shift_epoch,
)

LONGEST_US = 2.0**23
"""Longest step, and longest time since the epoch: float32 counts whole microseconds up to twice that."""


class StillRows:
    """The rows of a sensor that are drawn ahead, and the planes for that.

    pending: (height * width,) plane of the sensor. Rows ahead have nothing pending: their `since_us` takes
    its place, which saves 4 bytes a pixel.
    """

    def __init__(self, width: int, height: int, seed: int, pending: Plane) -> None:
        self._width, self._seed = width, seed
        self.allowed = False  # by the effects that are on
        self._rows = AheadRows(
            still_steps=np.zeros(height, np.int32),
            ahead=np.zeros(height, np.bool_),
            drawn_us=np.zeros(height, np.float32),
            since_us=pending,
            due_us=np.zeros(pending.size, np.float32),
            motion=np.zeros((pending.size, 2), np.float32),
        )
        self._changed, self._most_still_steps = height, 0  # how many rows change in a step; of all rows
        self.now_us, self.steps = 0.0, 0  # now_us: since the epoch

    def of_band(self, lines: slice) -> AheadRows:
        """Those of some rows of the sensor."""
        pixels, rows = slice(lines.start * self._width, lines.stop * self._width), self._rows
        return AheadRows(
            rows.still_steps[lines], rows.ahead[lines], rows.drawn_us[lines],
            rows.since_us[pixels], rows.due_us[pixels], rows.motion[pixels],
        )  # fmt: skip

    def restore(self, steps: int, now_us: float) -> None:
        """Be as after `wake_all`, so many steps after the beginning."""
        self._all_change()
        self._rows.ahead[:] = False
        self.steps, self.now_us = steps, now_us

    @property
    def nbytes(self) -> int:
        """Memory of the planes."""
        return int(self._rows.due_us.nbytes + self._rows.motion.nbytes)

    def look(self, before: Image, after: Image, span_us: float) -> None:
        """Note which rows change over a step of span_us."""
        if before.dtype == after.dtype and span_us <= LONGEST_US:
            self._changed, self._most_still_steps = count_still_steps(
                before.view(np.uint8), after.view(np.uint8), self._rows.still_steps
            )
        else:
            self._all_change()

    def wake(self, state: BandState) -> None:
        """Bring those rows of a band that are ahead, but change in this step, to its start."""
        if self._changed:
            key = interval_key(self._seed, BACK, self.steps)
            state.rows_ahead -= catch_up(*state.rows, *state.pixels, key, state.first_pixel, self.now_us)

    def wake_all(self, states: list[BandState]) -> None:
        """Bring all rows to the present: something else than the light changes."""
        self._all_change()
        for state in states:
            self.wake(state)

    def forget(self, states: list[BandState]) -> None:
        """Take all rows as they were when they were drawn ahead: what was drawn since is lost."""
        self._all_change()
        for state in states:
            state.pixels.pending.reshape(-1, self._width)[state.rows.ahead] = 0
            state.rows_ahead = 0
        self._rows.ahead[:] = False

    def draw_due(self, state: BandState, key: np.uint64, span_us: float, offset_us: float) -> None:
        """The events of a band's rows that are ahead, over a step that starts offset_us into its interval."""
        rows, above, below, now_us = state.rows, state.pixels.above, state.pixels.below, self.now_us
        found, first_pixel, width = state.workspace.near, state.first_pixel, self._width
        count = find_due(rows.ahead, rows.due_us, np.float32(now_us + span_us), found)
        state.workspace.draw(count, lambda done, keys: draw_due(
            rows.since_us, rows.due_us, rows.motion, above, below, key, span_us, offset_us, first_pixel,
            width, now_us, found, done, count, keys,
        ))  # fmt: skip

    def draw_ahead(self, state: BandState, span_us: float) -> None:
        """At the end of a step, draw those rows of a band ahead that have been unchanged for long enough."""
        if self._most_still_steps >= STILL_STEPS:
            key = interval_key(self._seed, AHEAD, self.steps)
            step = Step(key, span_us, 0.0, state.first_pixel, self._width)
            end_us = self.now_us + span_us
            state.rows_ahead += draw_ahead(*state.rows, *state.pixels, *state.motion, *step, end_us)

    def pass_by(self, span_us: float) -> None:
        """A step is over."""
        self.steps += 1
        self.now_us += span_us
        if self.now_us > LONGEST_US:
            rows = self._rows
            shift_epoch(rows.ahead, rows.drawn_us, rows.since_us, rows.due_us, np.float32(self.now_us))
            self.now_us = 0.0

    def _all_change(self) -> None:
        """No row stands still."""
        self._rows.still_steps[:] = 0
        self._changed, self._most_still_steps = self._rows.still_steps.size, 0
