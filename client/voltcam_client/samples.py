"""What a DAVIS gives beside events and frames: samples of its inertial measurement unit, and triggers."""

from typing import Final

import numpy as np
import numpy.typing as npt

IMU = np.dtype([("t", "<i8"), ("temperature_c", "<f4"), ("accel_g", "<f4", 3), ("gyro_deg_s", "<f4", 3)])
"""One sample: time in us, temperature of the chip, acceleration and rotation along x, y, z of the camera.

x goes right, y down and z along the view, as pixels do. A camera at rest feels the pull of its support:
(0, -1, 0) g where it stands upright.
"""

TRIGGER = np.dtype([("t", "<i8"), ("kind", "u1")])
"""One trigger: time in us, and one of TRIGGER_KINDS."""

TRIGGER_KINDS: Final = {
    "rising edge": 1,
    "falling edge": 2,
    "frame begins": 6,
    "frame ends": 7,
    "exposure begins": 8,
    "exposure ends": 9,
}
"""The numbers of dv-processing's `TriggerType`, which are those of a DAVIS' driver."""

ImuSamples = npt.NDArray[np.void]
Triggers = npt.NDArray[np.void]
