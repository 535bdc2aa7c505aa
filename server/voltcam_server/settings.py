"""What the daemon is told: command line over environment over file over defaults."""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import AfterValidator, Field, ValidationError
from pydantic_settings import (
    BaseSettings,
    EnvSettingsSource,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
    SettingsError,
)

from voltcam_simulator.parameters import merged

from .access import AccessSettings
from .camera_settings import DV_DEFAULT, DV_PORTS, CameraSettings
from .log import LogSettings
from .problems import KeyPath, UsageError, faults, one_line

ENV_PREFIX = "VOLTCAM_"
# Tokens and keys are no settings, since these may be shown; the last is where tests find recordings.
NOT_SETTINGS = {"VOLTCAM_TOKEN", "VOLTCAM_VIEW_TOKEN", "VOLTCAM_KEYS", "VOLTCAM_DATA"}
SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


MOST_CAMERAS = 16
CAMERA_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")


def _camera_name(name: str) -> str:
    if not CAMERA_NAME.fullmatch(name):
        raise ValueError("name a camera by at most 32 letters, digits, - and _, such as left")
    return name


CameraName = Annotated[str, AfterValidator(_camera_name)]


class Settings(CameraSettings, BaseSettings):
    """The config file of `voltcam serve`. All keys are optional.

    cameras: several in one daemon; what is said of a camera outside holds for those that do not say it.
    """

    model_config = SettingsConfigDict(title="Voltcam", frozen=True, extra="forbid")

    cameras: dict[CameraName, CameraSettings] = Field(
        default={},
        max_length=MOST_CAMERAS,
        description="several cameras in one daemon, by names of your own; what stands outside holds for each "
        "that does not say otherwise, and each has a zmq endpoint of its own",
    )

    access: AccessSettings = Field(
        default_factory=AccessSettings, description="who may use the daemon, and what they may name"
    )
    recordings: Path = Field(default=Path(), description="folder of the recordings that are begun over REST")
    least_free_bytes: int = Field(
        default=500_000_000, ge=0, description="a recording ends before its disk has less"
    )
    announce: bool = Field(
        default=False, description="tell the local network where the cameras are (multicast DNS)"
    )
    log: LogSettings = Field(default_factory=LogSettings, description="lines on standard error")
    http: str = Field(
        default="127.0.0.1:8560",
        pattern=r"^(\[[0-9A-Fa-f:.]+\]|[^:/\s]+):\d{1,5}$",
        examples=["127.0.0.1:8560"],
        description="HOST:PORT of REST, WebSocket and the page; beyond this machine it needs a token",
    )

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Only what `load` passes: it lays the layers over each other itself, to know which one is wrong."""
        return (init_settings,)

    def each(self) -> dict[str, CameraSettings]:
        """The cameras by name. Without `cameras` it is one, under the name of its camera file."""
        own = self.model_dump(exclude_unset=True, include=set(CameraSettings.model_fields))
        if not self.cameras:
            return {self.camera: CameraSettings.model_validate(own)}
        return {
            name: CameraSettings.model_validate(
                {"dv": _dv_of(number), **merged(own, camera.model_dump(exclude_unset=True))}
            )
            for number, (name, camera) in enumerate(self.cameras.items())
        }


def _dv_of(number: int) -> str:
    """Where a camera's DV streams are, where nothing is said of them: after those of the one before."""
    host, _, port = DV_DEFAULT.rpartition(":")
    return f"{host}:{int(port) + DV_PORTS * number}"


def load(
    command_line: Mapping[str, Any],
    config: Path | None = None,
    environment: Mapping[str, str] = os.environ,
) -> Settings:
    """The settings from all layers. Raises UsageError, which says which layer holds what is wrong."""
    layers = {
        "command line": dict(command_line),
        "environment": _from_environment(environment),
        str(config): _from_file(config) if config else {},
    }
    content: dict[str, Any] = {}
    for layer in reversed(layers.values()):
        content = merged(content, layer)
    try:
        settings = Settings(**content)
    except ValidationError as error:
        found = [f"{_origin(layers, path)}: {text}" for path, text in faults(error, Settings)]
        raise UsageError("; ".join(found)) from None
    _check_endpoints(settings.each())
    return settings


def _check_endpoints(cameras: Mapping[str, CameraSettings]) -> None:
    for key in ("zmq", "dv", "udp", "foxglove", "ros2"):
        seen: dict[str, str] = {}
        for name, camera in cameras.items():
            address = getattr(camera, key)
            if address in seen and not address.endswith(":0") and address != "off":
                raise UsageError(
                    f"cameras.{name}.{key}: {address} is that of {seen[address]}: give each camera its own"
                )
            seen[address] = name


def schema() -> dict[str, Any]:
    """The JSON schema of the config file, for editors."""
    return {"$schema": SCHEMA_DIALECT, **Settings.model_json_schema()}


def parse_change(text: str) -> dict[str, Any]:
    """ "comparator.theta_on=1.2" as {"comparator": {"theta_on": 1.2}}. Raises UsageError."""
    path, equals, value = text.partition("=")
    if not (path and equals and value):
        raise UsageError(f"--set {text}: give it as effect.name=value, such as comparator.theta_on=1.2")
    try:
        change: Any = yaml.safe_load(value)
    except yaml.YAMLError:
        change = value
    for key in reversed(path.strip().split(".")):
        change = {key: change}
    return dict(change)


def _from_file(path: Path) -> dict[str, Any]:
    try:
        content = yaml.safe_load(path.read_text())
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror}: check --config") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise UsageError(f"{path} is not readable as YAML: {one_line(error)}") from None
    except RecursionError:
        raise UsageError(f"{path} is nested too deep to be a config file") from None
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise UsageError(f"{path} must hold keys and values, such as `camera: davis346`")
    return {str(key): value for key, value in content.items()}


def _from_environment(environment: Mapping[str, str]) -> dict[str, Any]:
    """VOLTCAM_LAW, VOLTCAM_SOURCE__URI, VOLTCAM_PARAMETERS__COMPARATOR__THETA_ON..."""
    for name in environment:
        key = name.removeprefix(ENV_PREFIX).partition("__")[0].lower()
        if name.startswith(ENV_PREFIX) and name not in NOT_SETTINGS and key not in Settings.model_fields:
            raise UsageError(
                f"environment: {name}: there is no such setting, only {', '.join(Settings.model_fields)}"
            )
    try:
        source = EnvSettingsSource(Settings, env_prefix=ENV_PREFIX, env_nested_delimiter="__")
        source.env_vars = {name.lower(): value for name, value in environment.items()}
        return source()
    except SettingsError as error:
        raise UsageError(f"environment: {one_line(error)}") from None


def _origin(layers: Mapping[str, Mapping[str, Any]], path: KeyPath) -> str:
    """The first layer that says something at `path`."""
    return next((name for name, layer in layers.items() if _holds(layer, path)), "defaults")


def _holds(layer: Mapping[str, Any], path: KeyPath) -> bool:
    """Whether a layer has a value at `path`, or one on the way to it."""
    inner: Any = layer
    for key in path:
        if not isinstance(inner, Mapping):
            return True
        if key not in inner:
            return False
        inner = inner[key]
    return True
