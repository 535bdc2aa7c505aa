"""The lens gives less light to the corners."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, quantity
from ..kernel import kernel


class Vignetting(Effect):
    """Light times cos^4 of the angle to the axis, 1/(1 + g r^2)^2; r from the centre, g by corner_loss."""

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = (
        "leak, noise and lag of bright scenes in the centre, of darker ones in the corners"
    )
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    corner_loss: float = quantity(
        0.0, unit="1", ge=0, le=0.99, meaning="share of the light that a corner of the image lacks",
        source="cos^4 law: 0.17 at 17 degrees (DAVIS346, 12 mm lens), 0.5 at 33 degrees (6 mm)",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.corner_loss > 0

    def see(self, band: Band) -> None:
        sensor = band.sensor
        corner2 = max(((sensor.width - 1) ** 2 + (sensor.height - 1) ** 2) / 4, 1)
        g = ((1 - self.corner_loss) ** -0.5 - 1) / corner2
        middle_y, middle_x = np.float32((sensor.height - 1) / 2), np.float32((sensor.width - 1) / 2)
        band.apply(darken, band.light, band.place, sensor.height, middle_y, middle_x, np.float32(g))


@kernel
def darken(light: Any, place: Any, height: Any, middle_y: Any, middle_x: Any, g: Any) -> None:
    one = np.float32(1)
    for row in range(place.rows):
        y = np.float32((place.first_row + row) % height) - middle_y
        for column in range(place.columns):
            x = np.float32(place.first_column + column) - middle_x
            root = one + g * (x * x + y * y)
            light[row * place.columns + column] /= root * root
