"""Camera files as they lie on disk: YAML with a sensor's name and size, and beside these its parameters."""

from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, Field

_NAMED = files("voltcam_simulator") / "cameras"

SIDE_LIMIT = 8192
"""Pixels a side: an event keeps 13 bits for each coordinate while it is sorted."""

INTERVALS = "intervals"
"""The key of a calibrated file: by "effect.parameter", the low and high that each may as well have."""


class SensorSize(BaseModel):
    """A sensor without its parameters."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str = Field("camera", min_length=1, max_length=100)
    width: int = Field(346, ge=1, le=SIDE_LIMIT)
    height: int = Field(260, ge=1, le=SIDE_LIMIT)


def camera_names() -> list[str]:
    """Names that `read` knows."""
    entries = [entry.name for entry in _NAMED.iterdir()]
    return sorted(entry.removesuffix(".yaml") for entry in entries if entry.endswith(".yaml"))


def read(name_or_path: str | Path) -> dict[str, Any]:
    """The content of a named camera or of a YAML file.

    Raises ValueError for an unknown name or a file that is not one of a camera, OSError for one that cannot
    be read.
    """
    name = str(name_or_path)
    if name in camera_names():
        named: dict[str, Any] = yaml.safe_load(_NAMED.joinpath(f"{name}.yaml").read_text())
        return named
    if not name.endswith((".yaml", ".yml")):
        known = ", ".join(camera_names())
        raise ValueError(f"unknown camera {name!r}: give one of {known}, or a .yaml file")
    try:
        content = yaml.safe_load(Path(name).read_text())
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{name} is not readable as YAML: {' '.join(str(error).split())}") from None
    except RecursionError:
        raise ValueError(f"{name} is nested too deep to be a camera file") from None
    if not isinstance(content, dict):
        raise ValueError(
            f"{name} is not a camera file: it must hold name, width, height and parameters by effect"
        )
    return content


def divided(content: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """(name and size, parameters) of a camera file, without its intervals. Raises ValueError for a width
    without a height."""
    content = {key: value for key, value in content.items() if key != INTERVALS}
    size = {key: content[key] for key in SensorSize.model_fields if key in content}
    if ("width" in size) != ("height" in size):
        missing = "height" if "width" in size else "width"
        raise ValueError(
            f"{size.get('name', 'the camera')} has no {missing}: give width and height, or neither"
        )
    return size, {key: value for key, value in content.items() if key not in size}


def intervals_of(content: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """By "effect.parameter", the interval of each that a calibrated file has. Raises ValueError."""
    intervals = content.get(INTERVALS, {})
    try:
        return {str(name): (float(low), float(high)) for name, (low, high) in intervals.items()}
    except (AttributeError, TypeError, ValueError):
        raise ValueError("intervals: give effect.parameter: [low, high] for each") from None
