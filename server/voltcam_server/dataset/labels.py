"""Label images beside frames. They become ITEM.labels.npz: labels (M, height, width) uint8 or uint16, in the
sensor's pixels, and t_us (M,) int64."""

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from voltcam_client.formats import FormatError
from voltcam_client.formats.image_list import IMAGE_LIST, ListedImage, read_image_list
from voltcam_video import Fit, SourceError, fit_labels
from voltcam_video.sources.timed_images import images_in

from ..problems import one_line


class BesideError(ValueError):
    """One line: labels or a table that do not go with the frames, and the remedy."""


@dataclass(frozen=True)
class LabelImages:
    """paths: in order. t_us: their times, where a list beside them says so; None: those of the frames."""

    paths: tuple[Path, ...]
    t_us: tuple[int, ...] | None

    def at(self, frame_t_us: Sequence[int]) -> list[tuple[Path, int]]:
        """Those up to the last frame, with their times. Raises BesideError."""
        if self.t_us is None:
            if len(self.paths) < len(frame_t_us):
                raise BesideError(_counts(self.paths, len(frame_t_us)))
            return list(zip(self.paths, frame_t_us, strict=False))
        return [each for each in zip(self.paths, self.t_us, strict=True) if each[1] <= frame_t_us[-1]]


def label_images(folder: Path) -> LabelImages:
    """The label images in a folder, by its images.txt or by name. Raises BesideError."""
    try:
        if (folder / IMAGE_LIST).exists():
            listed: list[ListedImage] = read_image_list(folder / IMAGE_LIST)
            return LabelImages(tuple(one.path for one in listed), tuple(one.t_us for one in listed))
        return LabelImages(tuple(images_in(folder)), None)
    except (OSError, UnicodeDecodeError, FormatError, SourceError) as error:
        raise BesideError(f"labels: {one_line(error)}") from None


def check_labels(folder: Path, frames: int | None, size: tuple[int, int]) -> None:
    """Before anything is made. size: width and height of the frames. Raises BesideError."""
    found = label_images(folder)
    if found.t_us is None and frames is not None and len(found.paths) != frames:
        raise BesideError(_counts(found.paths, frames))
    for path in found.paths:
        try:
            with Image.open(path) as image:
                if image.size != size:
                    raise BesideError(
                        f"{path} has {image.size[0]}x{image.size[1]} pixels, its frame {size[0]}x{size[1]}: "
                        "give labels of the frames' size"
                    )
        except OSError as error:
            raise BesideError(f"{path} is not an image that can be read: {one_line(error)}") from None


def write_labels(path: Path, listed: list[tuple[Path, int]], size: tuple[int, int], how: Fit) -> None:
    """One image at a time: memory stays flat. Raises BesideError."""
    width, height = size
    first = _label(listed[0][0]) if listed else np.zeros((1, 1), np.uint8)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("labels.npy", "w", force_zip64=True) as member:
            shape = (len(listed), height, width)
            header = {"descr": first.dtype.str, "fortran_order": False, "shape": shape}
            np.lib.format.write_array_header_1_0(member, header)
            for file, _ in listed:
                label = _label(file)
                if label.dtype != first.dtype:
                    raise BesideError(f"{file} is {label.dtype}, the first one {first.dtype}: save all alike")
                member.write(fit_labels(label, width, height, how).tobytes())
        with archive.open("t_us.npy", "w") as member:
            np.lib.format.write_array(member, np.array([t_us for _, t_us in listed], np.int64))


def _counts(paths: Sequence[Path], frames: int) -> str:
    return (
        f"{paths[0].parent} has {len(paths)} label images for {frames} frames: give one for each frame, or a "
        f"list of their times ({IMAGE_LIST})"
    )


def _label(path: Path) -> NDArray[np.uint8 | np.uint16]:
    """Indices, also of a palette. Raises BesideError."""
    try:
        with Image.open(path) as image:
            if image.mode not in ("L", "P", "1", "I", "I;16"):
                raise BesideError(
                    f"{path} is a picture in {image.mode}: give indices, grey or with a palette"
                )
            label = np.asarray(image.convert("L") if image.mode == "1" else image)
    except OSError as error:
        raise BesideError(f"{path} is not an image that can be read: {one_line(error)}") from None
    if label.dtype == np.uint8:
        return label
    if label.min() < 0 or label.max() > 65_535:
        raise BesideError(f"{path} has values from {label.min()} to {label.max()}: give 0 to 65535")
    return label.astype(np.uint16)
