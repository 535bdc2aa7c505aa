"""A camera_info file, as ROS' camera_calibration and camera_info_manager write it.

Source: wiki.ros.org/camera_calibration_parsers.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from voltcam_client.errors import VoltcamError
from voltcam_client.formats.library import library

MOST_BYTES = 1 << 20
MOST_COEFFICIENTS = 64
_SHAPES = {"camera_matrix": 9, "rectification_matrix": 9, "projection_matrix": 12}


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Of sensor_msgs/CameraInfo: D, K, R, P, row by row. size: width, height; without one, not calibrated."""

    size: tuple[int, int] | None = None
    model: str = ""
    distortion: tuple[float, ...] = ()
    k: tuple[float, ...] = (0.0,) * 9
    r: tuple[float, ...] = (0.0,) * 9
    p: tuple[float, ...] = (0.0,) * 12


UNKNOWN_INTRINSICS = Intrinsics()


def read_intrinsics(path: Path) -> Intrinsics:
    """Raises VoltcamError, OSError."""
    yaml = library("yaml", path, extra="ros1")
    try:
        with path.open("rb") as file:
            text = file.read(MOST_BYTES)
        content = yaml.load(text, Loader=_no_aliases(yaml))
        return _intrinsics(content)
    except (
        yaml.YAMLError,
        RecursionError,
        UnicodeError,
        ValueError,
        TypeError,
        KeyError,
        OverflowError,
    ) as error:
        why = f"{type(error).__name__}: {error}" if isinstance(error, KeyError) else str(error)
        raise VoltcamError(
            f"{path} is no camera_info file ({' '.join(why.split())[:200]}): give one of camera_calibration"
        ) from None


def _no_aliases(yaml: Any) -> Any:
    """A safe loader; aliases could make a small file very large."""

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.events.AliasEvent):
                raise ValueError("it has aliases")
            return super().compose_node(parent, index)

    return Loader


def _intrinsics(content: Any) -> Intrinsics:
    """Raises ValueError, TypeError, KeyError."""
    size = content["image_width"], content["image_height"]
    if not all(type(side) is int and 0 < side < 1 << 16 for side in size):
        raise ValueError(f"image_width and image_height are {size[0]} and {size[1]}")
    distortion = _numbers(content["distortion_coefficients"]["data"])
    if len(distortion) > MOST_COEFFICIENTS:
        raise ValueError(f"{len(distortion)} distortion_coefficients")
    matrices = [_numbers(content[key]["data"]) for key in _SHAPES]
    for (key, count), matrix in zip(_SHAPES.items(), matrices, strict=True):
        if len(matrix) != count:
            raise ValueError(f"{key} has {len(matrix)} numbers, not {count}")
    return Intrinsics(size, str(content["distortion_model"]), distortion, *matrices)


def _numbers(data: Any) -> tuple[float, ...]:
    numbers = tuple(float(each) for each in data)
    if not all(map(math.isfinite, numbers)):
        raise ValueError("a number that is not finite")
    return numbers
