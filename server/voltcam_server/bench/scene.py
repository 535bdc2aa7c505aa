"""The scene that speed is measured on: what published figures for other simulators were measured on, too.

Smooth textures moving 1.5 pixels a frame, three hard edges, a flickering patch and a static one; 87 % of the
pixels change in each frame, and 0.19 events come for each pixel and frame at 240 fps (346x260, base model).
"""

import numpy as np
from numpy.typing import NDArray

PIXELS_PER_FRAME = 1.5


def moving(count: int, width: int, height: int) -> NDArray[np.uint8]:
    """(count, height, width) frames of the moving scene."""
    rng = np.random.default_rng(0)
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    waves = [
        (rng.uniform(0.05, 0.4), rng.uniform(-0.3, 0.3), rng.uniform(0, 6.3), rng.uniform(3, 11))
        for _ in range(14)
    ]
    frames = np.empty((count, height, width), np.uint8)
    for i in range(count):
        shifted = x + PIXELS_PER_FRAME * i
        image = np.full((height, width), 110, np.float32)
        for kx, ky, phase, size in waves:
            image += size * np.sin(kx * shifted + ky * y + phase)
        for share, step in ((0.2, 90.0), (0.5, -70.0), (0.8, 60.0)):
            behind = (x - share * width - PIXELS_PER_FRAME * i) % width
            image += step * (behind < 0.1 * width)
        patch(image, 0.1, 0.1)[:] *= 1 + 0.2 * np.sin(2 * np.pi * 100 * i / 240)
        patch(image, 0.65, 0.65)[:] = 120
        frames[i] = np.clip(image, 0, 255)
    return frames


def noisy(count: int, width: int, height: int) -> NDArray[np.uint8]:
    """A still scene through a webcam: noise of 2 DN in every frame."""
    still = moving(1, width, height)
    noise = np.random.default_rng(1).normal(0, 2, (count, height, width))
    return np.clip(still + noise, 0, 255).astype(np.uint8)


def patch(image: NDArray[np.float32], down: float, right: float) -> NDArray[np.float32]:
    """A square of a third of the height, its corner at these shares of height and width."""
    height, width = image.shape
    top, left, side = int(down * height), int(right * width), height // 3
    return image[top : top + side, left : left + side]
