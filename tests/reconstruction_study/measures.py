"""How far a reconstruction is from a frame."""

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float64]

SIGMA, SIDE = 1.5, 11
C1, C2 = 0.01**2, 0.03**2


def mse(image: Image, frame: Image) -> float:
    return float(np.mean((image - frame) ** 2))


def ssim(image: Image, frame: Image) -> float:
    """Of images in 0..1, with the window and constants of Wang, Bovik, Sheikh, Simoncelli (TIP 2004)."""

    def local(values: Image) -> Image:
        around = SIDE // 2
        return np.asarray(cv2.GaussianBlur(values, (SIDE, SIDE), SIGMA))[around:-around, around:-around]

    mean_a, mean_b = local(image), local(frame)
    var_a, var_b = local(image * image) - mean_a**2, local(frame * frame) - mean_b**2
    both = local(image * frame) - mean_a * mean_b
    same = (2 * mean_a * mean_b + C1) * (2 * both + C2)
    return float(np.mean(same / ((mean_a**2 + mean_b**2 + C1) * (var_a + var_b + C2))))


def equalised(image: Image) -> Image:
    """Every pixel's rank among all, in 0..1: events tell neither how bright a scene is nor its contrast."""
    flat = np.sort(image.ravel())
    low, high = np.searchsorted(flat, image, "left"), np.searchsorted(flat, image, "right")
    return (low + high) / (2 * flat.size)
