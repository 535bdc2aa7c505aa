"""A camera: a sensor's name and size, and its parameters."""

from pathlib import Path
from typing import Any

import yaml
from pydantic import Field

from .camera_file import SensorSize, divided, read
from .parameters import Parameters


class Camera(SensorSize):
    """A sensor: its name, its size in pixels (1 to 8192 a side), and its parameters."""

    parameters: Parameters = Field(default_factory=Parameters)

    @classmethod
    def load(cls, name_or_path: str | Path) -> "Camera":
        """A camera by name, or from a YAML file. What the file leaves out has its default.

        Raises ValueError for an unknown name or a file that is not one of a camera, OSError for an
        unreadable one, pydantic.ValidationError for unknown or impossible parameters.
        """
        return cls.from_mapping(read(name_or_path))

    @classmethod
    def from_mapping(cls, content: dict[str, Any]) -> "Camera":
        """From the flat layout of a camera file."""
        size, parameters = divided(content)
        return cls(**size, parameters=Parameters.model_validate(parameters))

    def to_yaml(self) -> str:
        """The camera file of this camera."""
        flat = self.model_dump(exclude={"parameters"}) | self.parameters.model_dump()
        return str(yaml.safe_dump(flat, sort_keys=False))
