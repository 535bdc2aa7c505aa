"""What the daemon is told: command line over environment over file over defaults."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic_settings import (
    BaseSettings,
    EnvSettingsSource,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
    SettingsError,
)

from voltcam_simulator import Camera, Law, Parameters
from voltcam_simulator.parameters import merged
from voltcam_video import SourceRequest

from .access import AccessSettings
from .log import LogSettings
from .overload import OverloadSettings
from .problems import KeyPath, UsageError, explain, faults, one_line

EncodingName = Literal["libcaer", "mono", "evt3", "libcaer_cmp"]
UPSAMPLE_WAYS = ("off", "linear", "cubic", "auto")
MOST_UPSAMPLE_STEPS = 64


def _upsample(value: object) -> object:
    """One of the ways, or a number of steps; in words of its own, since a union's errors name its parts."""
    if value is False:  # as YAML reads an off without quotes
        return "off"
    number = str(value)
    if value in UPSAMPLE_WAYS or (number.isdecimal() and 1 <= int(number) <= MOST_UPSAMPLE_STEPS):
        return value
    ways = ", ".join(UPSAMPLE_WAYS)
    raise ValueError(f"give {ways} or a number of steps from 1 to {MOST_UPSAMPLE_STEPS}")


Upsample = Annotated[
    Literal["off", "linear", "cubic", "auto"] | Annotated[int, Field(ge=1, le=MOST_UPSAMPLE_STEPS)],
    BeforeValidator(_upsample),
]
ENV_PREFIX = "VOLTCAM_"
# Tokens and keys are no settings, since these may be shown; the last is where tests find recordings.
NOT_SETTINGS = {"VOLTCAM_TOKEN", "VOLTCAM_VIEW_TOKEN", "VOLTCAM_KEYS", "VOLTCAM_DATA"}
SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"


class PacketSettings(BaseModel):
    """How events are cut into packets, and when these leave."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    smooth: bool = Field(
        default=True,
        description="the events of one frame interval leave at their own pace during the next one, as from a "
        "USB camera; false: all at once, as soon as they are known",
    )
    packet_us: int = Field(
        default=1000, ge=100, le=1000, description="longest packet in microseconds, where smooth"
    )
    packet_bytes: int = Field(
        default=65536, ge=8, le=2**24, description="largest packet, counted as 8 bytes for each event"
    )

    @property
    def packet_events(self) -> int:
        return self.packet_bytes // 8


class Settings(BaseSettings):
    """The config file of `voltcam serve`. All keys are optional."""

    model_config = SettingsConfigDict(title="Voltcam", frozen=True, extra="forbid")

    camera: str = Field(
        default="davis346", min_length=1, description="a camera's name, or the path of a camera file (.yaml)"
    )
    law: Law = Field(
        default="exact",
        description="exact: Brownian motion itself; paper: the algorithm of DVS-Voltmeter, as published",
    )
    seed: int = Field(default=0, ge=0, lt=2**63, description="the same seed and frames give the same events")
    source: SourceRequest = Field(default_factory=SourceRequest, description="where frames come from")
    upsample: Upsample = Field(
        default="off",
        description="frames between frames. linear: none, light goes in straight lines; cubic: on a monotone "
        "curve through the neighbouring frames, a frame later; auto: along the motion, in steps below a "
        "pixel; N: likewise, in N steps; off: linear in serve, cubic in convert",
    )
    parameters: Parameters = Field(
        default_factory=Parameters, description="changes to the camera's parameters, nested by effect"
    )
    packets: PacketSettings = Field(default_factory=PacketSettings, description="packets and their pace")
    overload: OverloadSettings = Field(
        default_factory=OverloadSettings, description="bounds of what is simulated at a time"
    )
    access: AccessSettings = Field(
        default_factory=AccessSettings, description="who may use the daemon, and what they may name"
    )
    recordings: Path = Field(default=Path(), description="folder of the recordings that are begun over REST")
    log: LogSettings = Field(default_factory=LogSettings, description="lines on standard error")
    encoding: EncodingName = Field(
        default="libcaer", description="of event packets; a WebSocket client may ask for another"
    )
    http: str = Field(
        default="127.0.0.1:8560",
        pattern=r"^(\[[0-9A-Fa-f:.]+\]|[^:/\s]+):\d{1,5}$",
        examples=["127.0.0.1:8560"],
        description="HOST:PORT of REST, WebSocket and the page; beyond this machine it needs a token",
    )
    zmq: str = Field(
        default="tcp://127.0.0.1:5560",
        pattern=r"^(tcp|ipc)://\S+$",
        examples=["tcp://127.0.0.1:5560"],
        description="ZeroMQ endpoint of events, frames and status; port 0 takes a free one",
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

    def load_camera(self) -> Camera:
        """The camera with the changed parameters. Raises UsageError."""
        camera = load_camera(self.camera)
        changes = self.parameters.model_dump(exclude_unset=True)
        return camera.model_copy(update={"parameters": camera.parameters.changed(changes)})


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
        return Settings(**content)
    except ValidationError as error:
        found = [f"{_origin(layers, path)}: {text}" for path, text in faults(error, Settings)]
        raise UsageError("; ".join(found)) from None


def load_camera(name_or_path: str) -> Camera:
    """A camera by name or file. Raises UsageError."""
    try:
        return Camera.load(name_or_path)
    except ValidationError as error:
        raise UsageError(f"{name_or_path}: {explain(error, Parameters)}") from None
    except OSError as error:
        raise UsageError(
            f"{name_or_path} cannot be read: {error.strerror}: check the name and its rights"
        ) from None
    except ValueError as error:
        raise UsageError(one_line(error)) from None


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
