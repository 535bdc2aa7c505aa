"""A band: some rows of the sensor, its part of all planes, and the workspace in which a thread works on it."""

from dataclasses import dataclass

import numpy as np

from .effect import Band, Plane
from .groups import AheadRows, Motion, Pixels, Step
from .workspace import Workspace


@dataclass(slots=True, eq=False)
class BandState:
    """The planes are views: of the sensor's, but motion and those of `band`, which are of the workspace."""

    workspace: Workspace
    band: Band
    place: slice
    """Its pixels among the sensor's."""
    pixels: Pixels
    motion: Motion
    rows: AheadRows
    light: Plane
    """What its pixels saw last [DN]."""
    response: Plane
    """Voltage that belongs to that [nominal thresholds]."""
    has_held: bool
    """Whether any of them may be in a dead time."""
    rows_ahead: int = 0
    """How many of its rows are drawn ahead."""

    def step(self, key: np.uint64, span_us: float = 0.0, offset_us: float = 0.0) -> Step:
        """A step of this band, as kernels take it."""
        return Step(key, span_us, offset_us, self.place.start, self.band.sensor.width)
