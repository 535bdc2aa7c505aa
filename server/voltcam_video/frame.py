"""A frame, its luminance, and its fit into the camera's pixel array."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from voltcam_video.opencv import cv2

Image = NDArray[np.uint8 | np.float32]
Fit = Literal["crop", "letterbox", "stretch"]
Resize = Callable[[NDArray[Any], int, int], NDArray[Any]]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a frame that a program sent. reason: one line, empty where it was simulated.

    shift_us: what was added to its time to have the events'.
    """

    result: Literal["simulated", "skipped", "dropped"]
    reason: str = ""
    shift_us: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Sent:
    """Of a frame that a program sent. wait: it is not dropped for a newer one. missed: frames that were,
    since the one before. tell: to be called once, from any thread, when its outcome is known.
    """

    wait: bool
    missed: int
    tell: Callable[[Outcome], None]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A luminance image and when it was taken.

    image: (H, W) uint8, or float32 in 0..255 where the source is finer than 8 bits.
    t_us: int microseconds; since the epoch for live sources and real-time pacing, else the source's own.
    events: of a recording that is replayed, those up to this frame; nothing is simulated then.
    position_us: of a recording, the time since its first frame.
    cut: the scene did not evolve continuously from the former frame: the first frame after a
        reconnection, and the first of every further round of a looped recording.
    sent: of a frame that a program sent, on its own clock.
    gamma: exponent from its grey levels to light; 1 where they are light.
    """

    image: Image
    t_us: int
    cut: bool = False
    events: NDArray[np.void] | None = None
    position_us: int | None = None
    sent: Sent | None = None
    gamma: float = 1.0


def luminance(image: NDArray[Any]) -> Image:
    """Grey, BGR or BGRA of 8 bit, 16 bit or float (0..255) as luminance (H, W), ITU-R BT.601 weights.

    8 bit stays uint8; 16 bit (full scale 65535) and float become float32 in 0..255.
    Raises ValueError for any other shape or type.
    """
    channels = image.shape[2] if image.ndim == 3 else 1
    if image.ndim not in (2, 3) or channels not in (1, 3, 4) or image.size == 0:
        raise ValueError(f"an image is (H, W), (H, W, 3) or (H, W, 4), not {image.shape}")
    if image.dtype == np.uint16:
        image = image.astype(np.float32) / np.float32(257)
    elif np.issubdtype(image.dtype, np.floating):
        image = image.astype(np.float32, copy=False)
    elif image.dtype != np.uint8:
        raise ValueError(f"an image is uint8, uint16 or float, not {image.dtype}")
    if channels == 1:
        return np.ascontiguousarray(image.reshape(image.shape[:2]))
    code = cv2.COLOR_BGR2GRAY if channels == 3 else cv2.COLOR_BGRA2GRAY
    return cv2.cvtColor(np.ascontiguousarray(image), code)  # type: ignore[return-value]


def fit(image: Image, width: int, height: int, how: Fit) -> Image:
    """`image` (H, W) as (height, width): shrinking averages areas, growing interpolates linearly.

    crop fills the array and loses the edges, letterbox shows all of it between black bars, stretch
    shows all of it out of proportion.
    """
    return _fitted(image, width, height, how, _resize)


def fit_labels(labels: NDArray[Any], width: int, height: int, how: Fit) -> NDArray[Any]:
    """An image of labels (H, W), uint8 or uint16, as `fit` puts the frame beside it: nothing is averaged, and
    beside a letterbox it is 0."""
    return _fitted(labels, width, height, how, _nearest)


def _fitted(image: NDArray[Any], width: int, height: int, how: Fit, resize: Resize) -> NDArray[Any]:
    if image.shape == (height, width):
        return image
    if how == "stretch":
        return resize(image, width, height)
    if how == "crop":
        return resize(_centre(image, width, height), width, height)
    scale = min(width / image.shape[1], height / image.shape[0])
    w = min(width, max(1, round(image.shape[1] * scale)))
    h = min(height, max(1, round(image.shape[0] * scale)))
    x, y = (width - w) // 2, (height - h) // 2
    boxed: NDArray[Any] = np.zeros((height, width), image.dtype)
    boxed[y : y + h, x : x + w] = resize(image, w, h)
    return boxed


def _centre(image: NDArray[Any], width: int, height: int) -> NDArray[Any]:
    """The largest part of `image` around its centre that has the proportions width : height."""
    rows, columns = image.shape
    scale = min(columns / width, rows / height)
    w, h = max(1, round(width * scale)), max(1, round(height * scale))
    x, y = (columns - w) // 2, (rows - h) // 2
    return image[y : y + h, x : x + w]


def _nearest(labels: NDArray[Any], width: int, height: int) -> NDArray[Any]:
    resized: Any = cv2.resize(
        np.ascontiguousarray(labels), (width, height), interpolation=cv2.INTER_NEAREST_EXACT
    )
    return np.ascontiguousarray(resized)


def _resize(image: NDArray[Any], width: int, height: int) -> NDArray[Any]:
    # In two steps, because OpenCV's area interpolation is one only where neither axis grows.
    rows, columns = image.shape
    shrunk = (min(width, columns), min(height, rows))
    resized: Any = image
    if shrunk != (columns, rows):
        resized = cv2.resize(resized, shrunk, interpolation=cv2.INTER_AREA)
    if shrunk != (width, height):
        resized = cv2.resize(resized, (width, height), interpolation=cv2.INTER_LINEAR)
    return np.ascontiguousarray(resized)
