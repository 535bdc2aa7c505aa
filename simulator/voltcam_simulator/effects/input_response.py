"""What a video camera did to the light before it wrote 8 bit grey levels, undone."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, Image, quantity
from ..exponential import power_of_e
from ..kernel import kernel
from ..logarithm import logarithm

_WHITE = 255.0


class InputResponse(Effect):
    """Light 255 ((F - black)/(255 - black))^gamma of a grey level F; below black it is 0."""

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = "the same video makes more events where it is dark: contrast grows by gamma"
    steady: ClassVar[bool] = True

    gamma_exponent: float = quantity(
        1.0, unit="1", ge=0.2, le=11,
        meaning="exponent from grey levels to light; 1: they are light already",
        source="2.2 of ITU-R BT.1886 and sRGB video is typical, and may come on top of a camera's own",
    )  # fmt: skip
    black_level_dn: float = quantity(
        0.0, unit="DN", ge=0, le=200, meaning="grey level of no light",
        source="16 in ITU-R BT.601 video range, 0 in full range",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.gamma_exponent != 1 or self.black_level_dn > 0

    def see(self, band: Band) -> None:
        band.apply(decode, band.light, *self._decoding)

    def light_of(self, image: Image) -> Image:
        """The light of grey levels (height, width)."""
        if not self.active:
            return image
        light = image.ravel().astype(np.float32)
        decode(light, *self._decoding)
        return light.reshape(image.shape)

    @property
    def _decoding(self) -> tuple[np.float32, np.float32, np.float32]:
        gain = 1 / (_WHITE - self.black_level_dn)
        return np.float32(self.black_level_dn), np.float32(gain), np.float32(self.gamma_exponent)


@kernel
def decode(light: Any, black: Any, gain: Any, gamma: Any) -> None:
    for i in range(light.shape[0]):
        share = max((light[i] - black) * gain, np.float32(1e-30))  # has a logarithm
        light[i] = np.float32(_WHITE) * power_of_e(gamma * logarithm(share))
