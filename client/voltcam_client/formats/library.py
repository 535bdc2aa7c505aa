"""Other people's readers: loaded when a file needs them, their complaints in one line."""

import contextlib
import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.errors import VoltcamError
from voltcam_client.formats.recording import FormatError


def library(name: str, path: Path, what: str = "reading", extra: str = "lab") -> Any:
    """The module, which is in this extra; FormatError says so where it is not; what: for which."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise FormatError(f"{path}: {what} it takes {name}: pip install 'voltcam[{extra}]'") from error


@contextlib.contextmanager
def named(path: Path, what: str) -> Iterator[None]:
    """A reader's complaint about `path` as a FormatError; the disk's own errors go on as they are."""
    try:
        yield
    except (VoltcamError, MemoryError, FileNotFoundError, PermissionError):
        raise
    except Exception as error:  # each library has its own, Exception itself among them
        first_line = next(iter(str(error).splitlines()), type(error).__name__)
        raise FormatError(
            f"{path} is cut short or no {what} ({first_line}): copy or record it again"
        ) from error


def grey(image: NDArray[Any], channels: str = "RGB") -> NDArray[np.uint8]:
    """Luminance (H, W) of an 8-bit image (H, W) or (H, W, 3 or 4), ITU-R BT.601, to half a level."""
    if image.dtype != np.uint8:
        raise ValueError(f"images are {image.dtype}, not 8 bit")
    if image.ndim == 2:
        return image
    weight = {"R": 299, "G": 587, "B": 114}
    total = np.full(image.shape[:2], 500, np.uint32)
    for index, channel in enumerate(channels[:3]):
        total += weight[channel] * image[..., index].astype(np.uint32)
    return (total // 1000).astype(np.uint8)


def stacked(images: list[NDArray[np.uint8]], path: Path) -> NDArray[np.uint8]:
    """Images of one size as (N, H, W)."""
    for number, image in enumerate(images):
        if image.shape != images[0].shape:
            raise FormatError(
                f"{path}: frame {number} is {image.shape[1]}x{image.shape[0]}, the first is "
                f"{images[0].shape[1]}x{images[0].shape[0]}: record one size"
            )
    return np.stack(images)
