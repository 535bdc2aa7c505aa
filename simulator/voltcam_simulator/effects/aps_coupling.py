"""The frames a DAVIS takes between its events disturb the event pixels."""

from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..effect import About, Band, Effect, quantity

NS_PER_US = 1000
_MEASURED = "measured on a DAVIS346 recording (street, static camera, 25 frames/s, exposure 500 us)"


class FrameTimes(NamedTuple):
    """Of a frame, in ns from its start: end of the reset scan, end of the exposure, end of the readout.

    period_ns: from frame to frame. begin_ns: of some frame on the time line.
    """

    exposed_ns: int
    read_ns: int
    end_ns: int
    period_ns: int
    begin_ns: int


class ApsCoupling(Effect):
    """Every frame, lines of the frame readout go up and down beside the pixel, and its voltage with them.

    A frame, as the time stamps of a DAVIS346 tell it: at its start the reset levels are read, row after row
    from row 0; then the exposure begins; at its end the signals are read, again row after row. A row's line
    is up for line_us, the exposure's for exposure_us; a kick goes with it and is taken back. Times are whole
    nanoseconds from the time line's zero, so every kick comes once, however time is cut.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = (
        "events crowd in the frame's phase: with the exposure, and in scans that move with the row"
    )

    frame_period_us: float = quantity(
        40_000.0, unit="us", ge=1000, le=1e7, meaning="from frame to frame", source=_MEASURED
    )
    exposure_us: float = quantity(
        500.0, unit="us", ge=1, le=1e6, meaning="exposure of a frame", source=_MEASURED
    )
    row_us: float = quantity(
        35.25, unit="us", ge=0.01, le=10_000, meaning="time to read a row", source=_MEASURED
    )
    line_us: float = quantity(
        0.0, unit="us", ge=0, le=1e6, meaning="how long a row's line is up; 0: until the next row's turn",
        source="row_us: as if one line were read at a time (assumed)",
    )  # fmt: skip
    offset_us: float = quantity(
        0.0,
        unit="us",
        ge=-1e7,
        le=1e7,
        meaning="start of some frame on the time line",
        source="camera's clock",
    )
    exposure_kick: float = quantity(
        0.0, unit="nominal thresholds", ge=-1, le=1, meaning="voltage while the exposure lasts",
        source="0.01 to 0.08 (assumed); DAVIS240C slider: ON before the frame stamp, OFF behind it",
    )  # fmt: skip
    reset_kick: float = quantity(
        0.0, unit="nominal thresholds", ge=-1, le=1, meaning="voltage while a row's reset level is read",
        source="0.01 to 0.08 (assumed); DAVIS346 street: 361 of 971 ON events of the scans",
    )  # fmt: skip
    readout_kick: float = quantity(
        0.0, unit="nominal thresholds", ge=-1, le=1, meaning="voltage while a row's signal is read",
        source="0.01 to 0.08 (assumed); DAVIS346 street: 610 of 971 ON events of the scans",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return any((self.exposure_kick, self.reset_kick, self.readout_kick))

    def times(self, height: int) -> FrameTimes:
        """When what happens in a frame of so many rows that is given out.

        It begins when the one before it has been read: of periods that are too short, several are one.
        """
        scan, period = height * round(self.row_us * NS_PER_US), round(self.frame_period_us * NS_PER_US)
        read = scan + round(self.exposure_us * NS_PER_US)
        periods = -(-(read + scan) // period)
        return FrameTimes(scan, read, read + scan, periods * period, round(self.offset_us * NS_PER_US))

    def drift(self, band: Band) -> None:
        period = round(self.frame_period_us * NS_PER_US)
        begin = band.start_us * NS_PER_US - round(self.offset_us * NS_PER_US)
        end = begin + round(band.span_us * NS_PER_US)
        for times, size in self._kicks(band):  # rows are in order of time
            for frame in range((begin - int(times[-1])) // period + 1, (end - int(times[0])) // period + 1):
                band.kicks.append(((times + (frame * period - begin)) / NS_PER_US, size))

    def _kicks(self, band: Band) -> list[tuple[NDArray[np.int64], float]]:
        """Kicks of one frame: (time for each row of the band [ns from the frame's start], size)."""
        sensor, row = band.sensor, round(self.row_us * NS_PER_US)
        line = round(self.line_us * NS_PER_US) or row
        rows = np.arange(band.place.rows, dtype=np.int64)
        scan = (band.first_row + rows) * row
        times = self.times(sensor.height)
        exposed, read = np.full_like(scan, times.exposed_ns), np.full_like(scan, times.read_ns)
        pulses = [
            (scan, scan + line, self.reset_kick),
            (exposed, read, self.exposure_kick),
            (read + scan, read + scan + line, self.readout_kick),
        ]
        return [kick for up, down, size in pulses if size for kick in ((up, size), (down, -size))]
