"""A pattern over the pixels that nobody has a name for, as a diagnosis finds it."""

from typing import ClassVar

import numpy as np

from ..effect import About, Effect, Sensor, quantity


class ResidualPattern(Effect):
    """Thresholds times 1 + on w and 1 + off w, w = cos(2 pi (across x + down y - crest)): a plane wave over
    the pixels.

    Half a wave over the width is a gradient, two pixels a wave are columns that take turns, rows, or a
    chequerboard.
    """

    about: ClassVar[About] = "pixel"
    signature: ClassVar[str] = (
        "pixels of the same rows, columns, corner or lattice always give more events than others"
    )
    steady: ClassVar[bool] = True

    on: float = quantity(
        0.0, unit="1", ge=-0.9, le=0.9, meaning="rise of the ON thresholds on the crest, relative",
        source="found by voltcam diagnose",
    )  # fmt: skip
    off: float = quantity(
        0.0, unit="1", ge=-0.9, le=0.9, meaning="rise of the OFF thresholds on the crest, relative",
        source="found by voltcam diagnose",
    )  # fmt: skip
    across_per_px: float = quantity(
        0.0, unit="1/pixel", ge=-0.5, le=0.5, meaning="waves a pixel along a row",
        source="found by voltcam diagnose",
    )  # fmt: skip
    down_per_px: float = quantity(
        0.0, unit="1/pixel", ge=-0.5, le=0.5, meaning="waves a pixel along a column",
        source="found by voltcam diagnose",
    )  # fmt: skip
    crest_turns: float = quantity(
        0.0, unit="1", ge=-1, le=1, meaning="turns of the wave from the first pixel to a crest",
        source="found by voltcam diagnose",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.on != 0 or self.off != 0

    def prepare(self, sensor: Sensor) -> None:
        y, x = np.ogrid[: sensor.height, : sensor.width]
        turns = self.across_per_px * x + self.down_per_px * y - self.crest_turns
        wave = np.cos(2 * np.pi * turns)
        sensor.theta_on *= 1 + self.on * wave
        sensor.theta_off *= 1 + self.off * wave
