"""Noise that frames have and light has not, kept from the pixels."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, Sensor, State, quantity
from ..kernel import kernel
from ..plane_kernels import copy


class FrameNoise(Effect):
    """Light follows a frame only where it would be more than slack_dn off.

    This is the play operator of mechanics: a level L within a band of slack_dn on each side of the frame F
    becomes min(max(L, F - slack_dn), F + slack_dn). It depends on the order of what frames show, not on their
    rate. Noise within the band moves nothing, and a change of light loses up to 2 slack_dn where it turns.
    """

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = "pixels at rest are calm, although frames are not"
    steady: ClassVar[bool] = True

    slack_dn: float = quantity(
        0.0, unit="DN", ge=0, le=100, meaning="by how much light may differ from a frame and not follow it",
        source="play operator (Krasnosel'skii, Pokrovskii 1989); frames of a DAVIS346 have 1.3 DN of noise",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.slack_dn > 0

    def state(self, sensor: Sensor) -> State:
        return {"level": np.zeros(sensor.width * sensor.height, np.float32)}

    def see(self, band: Band) -> None:
        level = band.planes[self.name]["level"]
        if band.span_us == 0:  # the image has been there for long
            band.apply(copy, band.light, level)
        else:
            band.apply(follow, band.light, np.float32(self.slack_dn), level)


@kernel
def follow(light: Any, slack: Any, level: Any) -> None:
    """level, and the light with it, becomes what is nearest to it within slack of the light."""
    for i in range(light.shape[0]):
        level[i] = min(max(level[i], light[i] - slack), light[i] + slack)
        light[i] = level[i]
