"""What a plane shows: the light of a photograph, cut out or without end."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_video.opencv import cv2
from voltcam_video.photos.light import Light, shrunk

FINENESS = 2  # texels per pixel: light between texels is interpolated, which blurs by up to half a texel
OPTICS_PX = 0.5  # sigma of the blur by lens and pixel area: finer detail would flicker as it moves
LONGEST = 2.0
BACKGROUND = 1.5  # sides of the background, in those of the frame; beyond, it is mirrored
CUTOUT = 0.3, 0.7  # sides of a cut-out, in the frame's shorter side
SOFT_PX = 4.0  # sigma of a soft edge
CORNERS = 5, 11


@dataclass(frozen=True)
class Plane:
    """light: (H, W) [DN], FINENESS texels to a pixel. cover: (H, W) in 0..1, how much of what lies behind is
    hidden; None hides all and goes on mirrored without end.
    """

    light: Light
    cover: Light | None

    @property
    def middle(self) -> tuple[float, float]:
        """Where pixel coordinates on the plane begin, in texels."""
        return (self.light.shape[1] - 1) / 2, (self.light.shape[0] - 1) / 2

    def seen(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[Light, Light | None]:
        """Light and cover at points of the plane [pixels from its middle], light multiplied by cover."""
        rows, columns = self.light.shape
        onto = _mirrored if self.cover is None else _clamped  # a cut-out hides nothing at its rim
        u = onto(x * FINENESS + self.middle[0], columns - 1)
        v = onto(y * FINENESS + self.middle[1], rows - 1)
        left, top = np.minimum(u.astype(np.int64), columns - 2), np.minimum(v.astype(np.int64), rows - 2)
        across, down = (u - left).astype(np.float32), (v - top).astype(np.float32)
        corners = [first := top * columns + left, first + 1, first + columns, first + columns + 1]

        def between(texels: Light) -> Light:
            a, b, c, d = (texels.take(corner) for corner in corners)
            upper, lower = a + across * (b - a), c + across * (d - c)
            return np.asarray(upper + down * (lower - upper), np.float32)

        return between(self.light), None if self.cover is None else between(self.cover)


def background(photograph: Light, width: int, height: int) -> Plane:
    """The photograph, BACKGROUND times as large as the frame along the side where it is scarcer, and at most
    LONGEST times that along the other.
    """
    rows, columns = photograph.shape
    most_rows, most_columns = (
        math.ceil(LONGEST * columns * height / width),
        math.ceil(LONGEST * rows * width / height),
    )
    photograph = photograph[:most_rows, :most_columns]
    rows, columns = photograph.shape
    scale = BACKGROUND * FINENESS * max(width / columns, height / rows)
    size = max(2, round(columns * scale)), max(2, round(rows * scale))
    return Plane(_blurred(shrunk(photograph, *size)), None)


def cutout(photograph: Light, width: int, height: int, rng: np.random.Generator) -> Plane:
    """A square piece of the photograph within a random polygon, whose edge is sharp or soft."""
    side = max(8, round(rng.uniform(*CUTOUT) * min(width, height) * FINENESS))
    shorter = min(photograph.shape)
    piece = max(1, round(rng.uniform(0.4, 1.0) * shorter))
    top, left = (int(rng.integers(0, size - piece + 1)) for size in photograph.shape)
    light = _blurred(shrunk(photograph[top : top + piece, left : left + piece], side, side))
    cover = _polygon(side, rng)
    soft = SOFT_PX if rng.random() < 0.5 else OPTICS_PX
    cover = _blurred(cover, soft)
    cover[[0, -1]] = cover[:, [0, -1]] = 0
    return Plane(light * cover, cover)


def _polygon(side: int, rng: np.random.Generator) -> Light:
    """A polygon around the middle, (side, side): 1 inside, with an edge a texel wide."""
    corners = int(rng.integers(*CORNERS))
    angles = (np.arange(corners) + rng.uniform(-0.35, 0.35, corners)) * (2 * np.pi / corners)
    radius = rng.uniform(0.45, 0.85, corners) * side / 2
    fine = 4
    points = (side / 2 + radius * np.array([np.cos(angles), np.sin(angles)])).T * fine
    mask = np.zeros((side * fine, side * fine), np.uint8)
    cv2.fillPoly(mask, [np.round(points).astype(np.int32)], 255)
    return shrunk(mask.astype(np.float32) / np.float32(255), side, side)


def _blurred(light: Light, sigma_px: float = OPTICS_PX) -> Light:
    sigma = sigma_px * FINENESS
    return np.asarray(cv2.GaussianBlur(light, (0, 0), sigma, borderType=cv2.BORDER_REFLECT_101), np.float32)


def _mirrored(x: NDArray[np.float64], last: int) -> NDArray[np.float64]:
    """Coordinates of a row of texels 0..last that goes on mirrored on both sides."""
    if x.min() >= 0 and x.max() <= last:
        return x
    folded: NDArray[np.float64] = np.mod(x, 2 * last)
    return np.minimum(folded, 2 * last - folded)


def _clamped(x: NDArray[np.float64], last: int) -> NDArray[np.float64]:
    return np.minimum(np.maximum(x, 0), last)
