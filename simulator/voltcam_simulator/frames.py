"""Frames as the sensor takes them: of its size, real, not negative, not too bright."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from .effect import Image
from .kernel import kernel

BRIGHTEST_DN = 1e12
"""More than the sun in a frame that shows a moonless night. From 1e20 on voltages are no numbers any more."""
NO_LIGHT = (
    "the frame has values that are negative or not finite, "
    f"or above {BRIGHTEST_DN:g} DN: grey levels start at 0"
)


def host_image(frame: ArrayLike, height: int, width: int) -> Image:
    """The frame as an own (height, width) array, uint8 or float32.

    Raises ValueError for another shape, what are no real numbers, and values that are no light.
    """
    image = np.asarray(frame)
    checked_shape(image.shape, height, width)
    if image.dtype == np.uint8:
        return image.copy(order="C")
    checked_kind(image.dtype)
    plane = image.astype(np.float32, order="C")
    if not _is_light(plane.ravel()):
        raise ValueError(NO_LIGHT)
    return plane


def checked_shape(shape: tuple[int, ...], height: int, width: int) -> None:
    """Raises ValueError for a shape that is not the sensor's."""
    if tuple(shape) != (height, width):
        raise ValueError(f"the frame is {tuple(shape)}, the sensor (height, width) = {(height, width)}")


def checked_kind(dtype: DTypeLike) -> None:
    """Raises ValueError for what are no real numbers."""
    if np.dtype(dtype).kind not in "buif":
        raise ValueError(f"the frame is of type {np.dtype(dtype)}: give real numbers")


@kernel
def _is_light(plane: Any) -> Any:
    """Whether all values (n,) are 0 to BRIGHTEST_DN; nan is not."""
    sound = True
    for i in range(plane.shape[0]):
        sound &= (plane[i] >= 0) & (plane[i] <= BRIGHTEST_DN)
    return sound
