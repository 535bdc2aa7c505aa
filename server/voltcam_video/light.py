"""Grey levels that stand for light, and those that are coded for screens."""

from typing import Literal

Levels = Literal["auto", "light", "video"]
VIDEO_GAMMA = 2.2
"""Exponent from coded grey levels to light: ITU-R BT.1886 and sRGB have about so much."""


def gamma_of(levels: Levels, coded: bool) -> float:
    """Exponent from grey levels to light; coded: whether the source's are, where nobody says."""
    return VIDEO_GAMMA if levels == "video" or (levels == "auto" and coded) else 1.0
