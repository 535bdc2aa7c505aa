"""A band: some rows of the sensor, their part of all planes, and the workspace a thread works on it in."""

from dataclasses import dataclass

from .effect import Band, Plane
from .groups import AheadRows, Kicks, Motion, Pixels
from .workspace import Workspace


@dataclass(slots=True, eq=False)
class BandState:
    """The planes are views: of the sensor's, but motion and those of `band`, which are of the workspace."""

    workspace: Workspace
    band: Band
    first_pixel: int
    """Number of its first pixel in the sensor."""
    width: int
    """Pixels in a row."""
    pixels: Pixels
    motion: Motion
    rows: AheadRows
    light: Plane
    """What its pixels saw last [DN]."""
    response: Plane
    """Voltage that belongs to that [nominal thresholds]."""
    no_kicks: Kicks
    """What kernels are given where there are no kicks."""
    has_held: bool
    """Whether any of its pixels may be in a dead time."""
    rows_ahead: int = 0
    """How many of its rows are drawn ahead."""

    def work_in(self, workspace: Workspace) -> None:
        """Take the workspace of the thread that works on the band next."""
        if workspace is not self.workspace:
            self.workspace, band = workspace, self.band
            band.light, band.response, band.drift, band.noise, band.bow, band.rate = workspace.planes[
                :, : band.light.size
            ]
            self.motion = Motion(band.drift, band.noise)
