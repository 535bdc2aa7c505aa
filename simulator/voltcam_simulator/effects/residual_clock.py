"""A clock that the pixels feel and nobody has a name for, as a diagnosis finds it."""

from typing import ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity

NS_PER_US = 1000


class ResidualClock(Effect):
    """The voltages go up by a kick once in each period and come down half a period later; each row so much
    later than the one above. The frames' own clock is that of `aps_coupling`.

    Times are whole nanoseconds from the time line's zero, so every kick comes once, however time is cut.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = (
        "a line in the spectrum of event times, ON and OFF half a period apart, its phase moving with the row"
    )

    kick: float = quantity(
        0.0, unit="nominal thresholds", ge=-1, le=1, meaning="voltage in the first half of a period",
        source="found by voltcam diagnose",
    )  # fmt: skip
    period_us: float = quantity(
        10_000.0, unit="us", ge=100, le=1e7, meaning="of the clock", source="found by voltcam diagnose"
    )
    begin_us: float = quantity(
        0.0, unit="us", ge=-1e7, le=1e7, meaning="start of some period in row 0 on the time line",
        source="found by voltcam diagnose",
    )  # fmt: skip
    row_us: float = quantity(
        0.0, unit="us", ge=-10_000, le=10_000, meaning="by how much each row is later than the one above",
        source="found by voltcam diagnose",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.kick != 0

    def drift(self, band: Band) -> None:
        period = round(self.period_us * NS_PER_US)
        begin = band.start_us * NS_PER_US - round(self.begin_us * NS_PER_US)
        end = begin + round(band.span_us * NS_PER_US)
        rows = band.first_row + np.arange(band.place.rows, dtype=np.int64)
        scan = rows * round(self.row_us * NS_PER_US)
        for after, size in ((0, self.kick), (period // 2, -self.kick)):
            times = scan + after
            for turn in range(
                (begin - int(times.max())) // period + 1, (end - int(times.min())) // period + 1
            ):
                band.kicks.append(((times + (turn * period - begin)) / NS_PER_US, size))
