"""Named cameras, and camera files: parameters in YAML, nested by effect, plus name, width, height."""

from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, Field

from ..parameters import Parameters

_NAMED = files(__name__)

SIDE_LIMIT = 8192
"""Pixels a side: an event keeps 13 bits for each coordinate while it is sorted."""


class Camera(BaseModel):
    """A sensor: its name, its size in pixels (1 to 8192 a side), and its parameters."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str = Field("camera", min_length=1, max_length=100)
    width: int = Field(346, ge=1, le=SIDE_LIMIT)
    height: int = Field(260, ge=1, le=SIDE_LIMIT)
    parameters: Parameters = Field(default_factory=Parameters)

    @classmethod
    def load(cls, name_or_path: str | Path) -> "Camera":
        """A camera by name, or from a YAML file. What the file leaves out has its default.

        Raises ValueError for an unknown name or a file that is not one of a camera, OSError for an
        unreadable one, pydantic.ValidationError for unknown or impossible parameters.
        """
        name = str(name_or_path)
        if name in camera_names():
            return cls.from_mapping(yaml.safe_load(_NAMED.joinpath(f"{name}.yaml").read_text()))
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
        return cls.from_mapping(content)

    @classmethod
    def from_mapping(cls, content: dict[str, Any]) -> "Camera":
        """From the flat layout of a camera file."""
        own = {key: content[key] for key in ("name", "width", "height") if key in content}
        if ("width" in own) != ("height" in own):
            missing = "height" if "width" in own else "width"
            raise ValueError(
                f"{own.get('name', 'the camera')} has no {missing}: give width and height, or neither"
            )
        rest = {key: value for key, value in content.items() if key not in own}
        return cls(**own, parameters=Parameters.model_validate(rest))

    def to_yaml(self) -> str:
        """The camera file of this camera."""
        flat = self.model_dump(exclude={"parameters"}) | self.parameters.model_dump()
        return str(yaml.safe_dump(flat, sort_keys=False))


def camera_names() -> list[str]:
    """Names that `Camera.load` knows."""
    entries = [entry.name for entry in _NAMED.iterdir()]
    return sorted(entry.removesuffix(".yaml") for entry in entries if entry.endswith(".yaml"))
