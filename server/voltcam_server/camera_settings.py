"""What one camera is told: pixel, source, packets and where these go."""

import re
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from voltcam_client.encodings import ENCODINGS, EVENT
from voltcam_client.errors import PacketError
from voltcam_client.formats.ros_messages import EventsAs
from voltcam_client.ros2 import Ros2Error
from voltcam_client.ros2.names import topic_name
from voltcam_simulator import Camera, Device, Law, Parameters
from voltcam_video import SourceRequest

from .beside import DavisSettings
from .overload import OverloadSettings
from .problems import UsageError, explain, one_line

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


DV_DEFAULT = "127.0.0.1:7777"
DV_PORTS = 4  # of a camera
_DV_ADDRESS = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[^:/\s]+):\d{1,5}")
_UDP_URL = re.compile(rf"(spif|t32_x16_y15_on1)://{_DV_ADDRESS.pattern}")


def _dv(value: object) -> object:
    if value is False or value == "off":  # False: as YAML reads an off without quotes
        return "off"
    if isinstance(value, str) and _DV_ADDRESS.fullmatch(value):
        if int(value.rpartition(":")[2]) <= 65535 - DV_PORTS + 1:
            return value
        raise ValueError(f"the streams take {DV_PORTS} ports, and none is above 65535")
    raise ValueError("give HOST:PORT, such as 127.0.0.1:7777, or off")


Dv = Annotated[str, BeforeValidator(_dv)]


def _foxglove(value: object) -> object:
    if value is False or value == "off":
        return "off"
    if isinstance(value, str) and _DV_ADDRESS.fullmatch(value) and int(value.rpartition(":")[2]) < 65536:
        return value
    raise ValueError("give HOST:PORT, such as 127.0.0.1:8765, or off")


Foxglove = Annotated[str, BeforeValidator(_foxglove)]


def _udp(value: object) -> object:
    if value is False or value == "off":
        return "off"
    if isinstance(value, str) and _UDP_URL.fullmatch(value) and 0 < int(value.rpartition(":")[2]) < 65536:
        return value
    raise ValueError("give spif://HOST:PORT, t32_x16_y15_on1://HOST:PORT, or off")


Udp = Annotated[str, BeforeValidator(_udp)]


def _ros2(value: object) -> object:
    if value is False or value == "off":  # False: as YAML reads an off without quotes
        return "off"
    try:
        return topic_name(value if isinstance(value, str) else "")
    except Ros2Error:
        raise ValueError("give a namespace of ROS 2, such as dvs, or off") from None


Ros2 = Annotated[str, BeforeValidator(_ros2)]


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


class CameraSettings(BaseModel):
    """A camera of the config file. All keys are optional."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    camera: str = Field(
        default="davis346", min_length=1, description="a camera's name, or the path of a camera file (.yaml)"
    )
    law: Law = Field(
        default="exact",
        description="exact: Brownian motion itself; paper: the algorithm of DVS-Voltmeter, as published",
    )
    device: Device = Field(
        default="cpu", description="what simulates: cpu, or cuda, a GPU (needs the extra cuda)"
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
    davis: DavisSettings = Field(
        default_factory=DavisSettings, description="what a DAVIS gives beside its events"
    )
    overload: OverloadSettings = Field(
        default_factory=OverloadSettings, description="bounds of what is simulated at a time"
    )
    encoding: EncodingName = Field(
        default="libcaer", description="of event packets; a WebSocket client may ask for another"
    )
    zmq: str = Field(
        default="tcp://127.0.0.1:5560",
        pattern=r"^(tcp|ipc)://\S+$",
        examples=["tcp://127.0.0.1:5560"],
        description="ZeroMQ endpoint of events, frames and status; port 0 takes a free one",
    )

    dv: Dv = Field(
        default=DV_DEFAULT,
        examples=["127.0.0.1:7777", "off"],
        description="HOST:PORT of the DV streams that dv-processing reads: events there, frames on the next "
        "port; port 0 takes free ones; off: none",
    )
    ros2: Ros2 = Field(
        default="off",
        examples=["dvs", "off"],
        description="namespace of the topics of ROS 2: events, image_raw, camera_info and imu; off: none",
    )
    ros2_messages: EventsAs = Field(
        default="packet",
        description="events there as event_camera_msgs/EventPacket; array: as dvs_msgs/EventArray",
    )
    camera_info: Path | None = Field(
        default=None,
        examples=["davis.yaml"],
        description="intrinsics for camera_info there, as ROS' camera_calibration writes them; without it "
        "zeros, which say that the camera is not calibrated",
    )

    udp: Udp = Field(
        default="off",
        examples=["spif://127.0.0.1:3333", "t32_x16_y15_on1://127.0.0.1:3333"],
        description="FORM://HOST:PORT to which events are sent as datagrams. spif: AEStream's words, without "
        "times; t32_x16_y15_on1: faery's records; off: they are not sent",
    )
    foxglove: Foxglove = Field(
        default="off",
        examples=["127.0.0.1:8765"],
        description="HOST:PORT of a server for Foxglove: frames and a preview of events (needs the extra "
        "foxglove); port 0 takes a free one; off: none",
    )

    def load_camera(self) -> Camera:
        """The camera with the changed parameters. Raises UsageError."""
        camera = load_camera(self.camera)
        changes = self.parameters.model_dump(exclude_unset=True)
        return camera.model_copy(update={"parameters": camera.parameters.changed(changes)})


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


def check_encoding(encoding: str, width: int, height: int) -> None:
    """Raises UsageError for an encoding that is none, or cannot hold the last pixel of such a camera."""
    if encoding not in ENCODINGS:
        raise UsageError(f"unknown encoding {encoding!r}: give one of {', '.join(ENCODINGS)}")
    try:
        ENCODINGS[encoding].encode(np.array([(0, width - 1, height - 1, True)], EVENT), 0)
    except PacketError as error:
        raise UsageError(one_line(error)) from None
