"""What events tell before anything is fitted: from here the catalogue takes sizes and times."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from voltcam_simulator.effect import Events

from ...statistics import Setting


@dataclass(frozen=True, eq=False)
class Clues:
    """Events (EVENT dtype) in a setting. row_us: time between rows of the frame readout, None: not known.
    delay_us: by how much the camera file's model delays all events."""

    setting: Setting
    events: Events
    row_us: float | None = None
    delay_us: float = 0.0

    @property
    def seconds(self) -> float:
        """Length of the recording [s]."""
        t_us = self.setting.scene.t_us
        return float(t_us[-1] - t_us[0]) * 1e-6

    @property
    def pixels(self) -> int:
        """Number of pixels."""
        return self.setting.scene.width * self.setting.scene.height

    @cached_property
    def t_us(self) -> NDArray[np.int64]:
        """(n,) times of the events."""
        return self.events["t"].astype(np.int64)

    @property
    def peak_rate_per_s(self) -> float:
        """Events per second in the busiest thousandth of all milliseconds."""
        begin_us = int(self.setting.scene.t_us[0])
        per_ms = np.bincount((self.t_us - begin_us) // 1000) if self.t_us.size else np.zeros(1)
        return float(np.quantile(per_ms, 0.999)) * 1000

    @property
    def tick_us(self) -> int:
        """The largest time of which all time stamps are multiples."""
        return timestamp_tick_us(self.t_us)


def timestamp_tick_us(t_us: NDArray[np.int64]) -> int:
    """The largest time of which all t_us (n,) are multiples; 1 without events."""
    return max(1, int(np.gcd.reduce(t_us))) if t_us.size else 1
