"""From a photograph to the light that fell on the camera which took it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_video.opencv import cv2

Light = NDArray[np.float32]

LUMINANCE_BGR = (0.0722, 0.7152, 0.2126)
"""Of linear light with sRGB's primaries (IEC 61966-2-1, ITU-R BT.709)."""


def light_of(photograph: NDArray[Any]) -> Light:
    """The light of a photograph, (H, W) float32 in 0..255 DN.

    photograph: (H, W), (H, W, 3) BGR or (H, W, 4) BGRA. uint8 and uint16 are coded as sRGB (IEC 61966-2-1)
    and are decoded; float is light in 0..255 already. Raises ValueError for any other shape or type.
    """
    channels = photograph.shape[2] if photograph.ndim == 3 else 1
    if photograph.ndim not in (2, 3) or channels not in (1, 3, 4) or photograph.size == 0:
        raise ValueError(
            f"a photograph is (H, W), (H, W, 3) or (H, W, 4) and not empty, not {photograph.shape}"
        )
    if photograph.dtype in (np.uint8, np.uint16):
        full = np.iinfo(photograph.dtype).max
        light = _decoded(np.arange(full + 1) / full)[photograph]
    elif np.issubdtype(photograph.dtype, np.floating):
        light = photograph.astype(np.float32)
    else:
        raise ValueError(f"a photograph is uint8, uint16 or float, not {photograph.dtype}")
    grey = light if channels == 1 else light[..., :3] @ np.array(LUMINANCE_BGR, np.float32)
    return np.reshape(grey, photograph.shape[:2])


def smaller(light: Light, longest: int) -> Light:
    """By a whole factor, so that no side is longer; areas are averaged."""
    step = -(-max(light.shape) // longest)
    rows, columns = (max(1, size // step) for size in light.shape)
    parts = light[: rows * step, : columns * step].reshape(rows, -1, columns, step)
    return np.asarray(parts.mean(axis=(1, 3), dtype=np.float64), np.float32)


def shrunk(light: Light, width: int, height: int) -> Light:
    """`light` as (height, width); areas are averaged where it shrinks."""
    smaller = width <= light.shape[1] and height <= light.shape[0]
    how = cv2.INTER_AREA if smaller else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(light, (width, height), interpolation=how), np.float32)


def _decoded(coded: NDArray[np.float64]) -> Light:
    """0..1 of sRGB to light of 0..255 DN."""
    light = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    return (255 * light).astype(np.float32)
