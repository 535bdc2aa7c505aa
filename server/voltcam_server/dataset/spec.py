"""What a data set is to be: the file that `voltcam dataset make` takes."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from voltcam_lab.drawn_camera import CameraDistribution
from voltcam_simulator import Device, Law
from voltcam_simulator.parameters import merged
from voltcam_video import Fit, Levels
from voltcam_video.sources.timed_images import Unit

from ..camera_settings import Upsample
from ..problems import UsageError, explain, one_line

Format = Literal[".h5", ".aedat4", ".npz"]


def _listed(given: Any) -> Any:
    return given if isinstance(given, list) else [given]


class Input(BaseModel):
    """Videos, .npz with frames, or folders of images that a pattern names."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _pattern_alone(cls, given: Any) -> Any:
        return {"files": given} if isinstance(given, str) else given

    files: str = Field(
        min_length=1, description="a pattern, such as videos/**/*.mp4; a folder of images is one"
    )
    name: str = Field("", description="before the names of its items, where two inputs have the same names")
    fps: float | None = Field(None, gt=0, le=1e6, description="of images without times, and of scenes")
    stamps: str | None = Field(
        None, description="a file with a time for each image, as seen from their folder"
    )
    stamps_unit: Unit = Field("s", description="of these times")
    scenes: int | None = Field(
        None, ge=1, le=1_000_000, description="of a folder of photographs: so many scenes in which they move"
    )
    layers: int | None = Field(None, ge=1, le=16, description="of such a scene")
    speed: float | None = Field(None, gt=0, le=1e5, description="of such a scene, pixels a second")
    truth: bool = Field(False, description="flow and depth order of such a scene, beside its events")
    labels: str | None = Field(
        None,
        description="a folder with a label image for each frame; {stem}, {name}, {folder} are the item's",
    )
    table: str | None = Field(
        None, description="a CSV with a column t_us or frame; {stem}, {name}, {folder} are the item's"
    )


class Spec(BaseModel):
    """A data set. The same spec and inputs give the same bytes."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    inputs: Annotated[tuple[Input, ...], BeforeValidator(_listed), Field(min_length=1)]
    camera: Annotated[tuple[str, ...], BeforeValidator(_listed), Field(min_length=1)] = Field(
        ("davis346",), description="names or camera files, of which one is drawn for each item"
    )
    intervals: bool = Field(False, description="draw each parameter from its interval in the camera file")
    parameters: dict[str, Any] = Field(
        {},
        description="by effect: a value, {uniform: [LOW, HIGH]}, {log_uniform: ...}, {choice: ...}, interval",
    )
    law: Law = "exact"
    device: Device = "cpu"
    upsample: Upsample = "cubic"
    fit: Fit = "crop"
    levels: Levels = "auto"
    variants: int = Field(1, ge=1, le=1_000_000, description="of each input, each with a camera of its own")
    seed: int = Field(0, ge=0, lt=2**63)
    seconds: float | None = Field(
        None, gt=0, description="of each input, from its beginning; none: all of it"
    )
    format: Format = ".h5"
    frames: bool = Field(True, description="whether items have their frames")
    shard: int | None = Field(None, ge=1, description="items to a folder; none: all are in one")

    def cameras(self) -> CameraDistribution:
        """Raises UsageError for what cannot be drawn."""
        try:
            return CameraDistribution.of(self.camera, self.parameters, intervals=self.intervals)
        except (OSError, ValueError) as error:
            raise UsageError(one_line(error)) from None


def load_spec(path: Path, over: Mapping[str, Any] | None = None) -> Spec:
    """From YAML; the paths in it are as seen from its folder. over: laid over it. Raises UsageError."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror}") from None
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise UsageError(f"{path} is not readable as YAML: {one_line(error)}") from None
    if not isinstance(content, dict):
        raise UsageError(f"{path} must hold keys and values, such as `inputs: videos/*.mp4`")
    return spec_of(merged(content, over or {}), str(path), path.parent)


def spec_of(content: Mapping[str, Any], origin: str, folder: Path = Path()) -> Spec:
    """origin: for messages. folder: what paths are seen from; they become absolute, since workers elsewhere
    have folders of their own. Raises UsageError."""
    folder = folder.absolute()
    try:
        spec = Spec.model_validate(dict(content))
    except ValidationError as error:
        raise UsageError(f"{origin}: {explain(error, Spec)}") from None
    found = spec.model_copy(update={
        "inputs": tuple(
            each.model_copy(update={"files": str(folder / each.files)} | _seen_from(folder, each))
            for each in spec.inputs
        ),
        "camera": tuple(str(folder / name) if _is_file(name) else name for name in spec.camera),
    })  # fmt: skip
    found.cameras()
    if spec.seconds is None and any(each.scenes is not None for each in spec.inputs):
        raise UsageError(f"{origin}: scenes do not end by themselves: give seconds")
    return found


def _seen_from(folder: Path, each: Input) -> dict[str, str]:
    return {
        key: str(folder / value)
        for key in ("labels", "table")
        if (value := getattr(each, key)) is not None and not value.startswith("{folder}")
    }


def _is_file(camera: str) -> bool:
    return camera.endswith((".yaml", ".yml"))
