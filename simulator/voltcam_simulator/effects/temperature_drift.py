"""The die warms up and cools down while it records."""

import math
from typing import ClassVar

from ..effect import About, Band, Effect, quantity

COLDEST_C, HOTTEST_C = -40.0, 125.0
"""Where a drift ends: the limits of `temperature_c`."""


class TemperatureDrift(Effect):
    """temperature_c + rate t + amplitude sin(2 pi t/period), t from when it is set, or the first frame."""

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = "the rate of ON events at rest rises or falls over minutes, OFF does not"

    rate_c_per_s: float = quantity(
        0.0, unit="C/s", ge=-10, le=10, meaning="steady warming",
        source="0.01 to 0.05: a camera that was just switched on (assumed)",
    )  # fmt: skip
    amplitude_c: float = quantity(
        0.0,
        unit="C",
        ge=0,
        le=80,
        meaning="amplitude of a slow swing",
        source="1 to 3: room climate (assumed)",
    )
    period_s: float = quantity(
        600.0, unit="s", gt=0, le=1e6, meaning="period of that swing", source="air conditioning (assumed)"
    )

    @property
    def active(self) -> bool:
        return self.rate_c_per_s != 0 or self.amplitude_c > 0

    def see(self, band: Band) -> None:
        band.temperature_c = self._at(band, band.elapsed_us + band.span_us)

    def drift(self, band: Band) -> None:
        band.temperature_c = self._at(band, band.elapsed_us + 0.5 * band.span_us)

    def _at(self, band: Band, elapsed_us: float) -> float:
        t_s = (elapsed_us - band.sensor.set_us[self.name]) * 1e-6
        swing = self.amplitude_c * math.sin(2 * math.pi * t_s / self.period_s)
        drifted = band.sensor.temperature_c + self.rate_c_per_s * t_s + swing
        return min(max(drifted, COLDEST_C), HOTTEST_C)
