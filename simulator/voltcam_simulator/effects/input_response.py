"""What a video camera did to the light before it wrote 8 bit grey levels, undone."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Band, Effect, Image, quantity
from ..exponential import power_of_e
from ..kernel import kernel
from ..logarithm import logarithm

_WHITE = 255.0
MOST_LIGHT_DN = 1e6
"""Of decoded light: more than the sun in a frame that shows a cloudy day."""
FIRST_DN = 1.0
"""A grey level, in which black becomes what is known, and what is known becomes white."""


class InputResponse(Effect):
    """Light 255 ((F - black + pedestal)/(255 - black))^gamma of a grey level F.

    Both ends of the scale stand for light that it does not tell. Black, and what is below it, is half of the
    pedestal: light there may be anything from 0 to where grey levels begin. White, and what is above it, is
    F - black times highlight: light there may be anything more.
    """

    about: ClassVar[About] = "light"
    signature: ClassVar[str] = "the same video makes more events where it is dark: contrast grows by gamma"
    steady: ClassVar[bool] = True
    instant: ClassVar[bool] = True

    gamma_exponent: float = quantity(
        1.0, unit="1", ge=0.2, le=11,
        meaning="exponent from grey levels to light; 1: they are light already",
        source="2.2 of ITU-R BT.1886 and sRGB video is typical, and may come on top of a camera's own",
    )  # fmt: skip
    black_level_dn: float = quantity(
        0.0, unit="DN", ge=0, le=200, meaning="grey level of no light",
        source="16 in ITU-R BT.601 video range, 0 in full range",
    )  # fmt: skip

    pedestal_dn: float = quantity(
        0.0, unit="DN", ge=0, le=200, meaning="light at which grey levels begin: less is black, too",
        source="DAVIS240C slider: 8.8 (a tenth of its levels are 0, and pixels tell of changes there)",
    )  # fmt: skip
    white_level_dn: float = quantity(
        255.0, unit="DN", ge=2, le=255, meaning="grey level at which frames are full",
        source="255 of 8 bits; DAVIS240C slider: 113 to 118, each pixel's own",
    )  # fmt: skip
    highlight: float = quantity(
        1.0, unit="1", ge=1, le=10, meaning="light of a full pixel, by how much it is more than white",
        source="1: white is what it says; DAVIS346 street, a white car in the sun: 1.26; slider: 1.34",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return (
            self.gamma_exponent != 1 or self.black_level_dn > 0 or self.pedestal_dn > 0 or self.highlight > 1
        )

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
    def _decoding(self) -> tuple[np.float32, ...]:
        return (
            np.float32(self.black_level_dn), np.float32(self.pedestal_dn),
            np.float32(self.white_level_dn - FIRST_DN), np.float32(self.highlight - 1),
            np.float32(1 / (_WHITE - self.black_level_dn)), np.float32(self.gamma_exponent),
        )  # fmt: skip


@kernel
def decode(light: Any, black: Any, pedestal_dn: Any, full: Any, more: Any, gain: Any, gamma: Any) -> None:
    """full: the level from which on pixels begin to be full [DN], more: by how much light then is more."""
    half, one = np.float32(0.5) * pedestal_dn, np.float32(FIRST_DN)
    for i in range(light.shape[0]):
        above = max(light[i] - black, np.float32(0))
        pedestal = half + half * min(above, one)  # all of it from the first level on
        above *= one + more * min(max(light[i] - full, np.float32(0)), one)
        share = max((above + pedestal) * gain, np.float32(1e-30))  # has a logarithm
        light[i] = min(np.float32(_WHITE) * power_of_e(gamma * logarithm(share)), np.float32(MOST_LIGHT_DN))
