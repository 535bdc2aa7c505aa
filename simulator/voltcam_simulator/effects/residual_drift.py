"""A drift nobody has a name for, as a diagnosis finds it."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..exponential import power_of_e
from ..kernel import kernel
from ..logarithm import logarithm

REFERENCE_DN = 128.0


class ResidualDrift(Effect):
    """Drift per_us ((L + dark_dn)/(128 + dark_dn))^power (1 + across u + down v), u and v from -1 to 1 over
    the image: what is left to say of a drift whose mechanism is unknown.
    """

    about: ClassVar[About] = "noise"
    signature: ClassVar[str] = (
        "ON or OFF events at rest that no known effect gives, smooth in brightness and place"
    )
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    per_us: float = quantity(
        0.0, unit="1/us", ge=-1, le=1, meaning="drift at 128 DN in the middle of the image",
        source="found by voltcam diagnose; the leak of a DAVIS346 there is 7.4e-7",
    )  # fmt: skip
    power: float = quantity(
        0.0, unit="1", ge=-4, le=4, meaning="how it goes with brightness",
        source="found by voltcam diagnose",
    )  # fmt: skip
    dark_dn: float = quantity(
        20.0, unit="DN", gt=0, le=1000, meaning="added to the brightness", source="as k2 (assumed)"
    )
    across: float = quantity(
        0.0, unit="1", ge=-100, le=100, meaning="growth from the middle to the right edge, relative",
        source="found by voltcam diagnose",
    )  # fmt: skip
    down: float = quantity(
        0.0, unit="1", ge=-100, le=100, meaning="growth from the middle to the lower edge, relative",
        source="found by voltcam diagnose",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.per_us != 0

    def drift(self, band: Band) -> None:
        sensor = band.sensor
        band.apply(
            add_power, band.light_before, band.light, self.per_us * band.span_us, self.power, self.dark_dn,
            self.across, self.down, band.place, sensor.width, sensor.height, band.drift,
        )  # fmt: skip


@kernel
def add_power(
    first: Any, last: Any, size: Any, power: Any, dark: Any, across: Any, down: Any, place: Any,
    width: Any, height: Any, drift: Any,
) -> None:  # fmt: skip
    for row in range(place.rows):
        v = 2.0 * ((place.first_row + row) % height) / max(height - 1, 1) - 1
        for column in range(place.columns):
            u = 2.0 * (place.first_column + column) / max(width - 1, 1) - 1
            i = row * place.columns + column
            level = powered(first[i], last[i], power, dark)
            drift[i] += np.float32(size * level * (1 + across * u + down * v))


@kernel
def powered(first: Any, last: Any, power: Any, dark: Any) -> Any:
    """Float32: ((L + dark)/(128 + dark))^power, L the mean of first and last."""
    half_scale = np.float32(0.5 / (REFERENCE_DN + dark))
    level = (first + last + np.float32(2 * dark)) * half_scale
    return power_of_e(np.float32(power) * logarithm(level))
