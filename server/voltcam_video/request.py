"""What a user asks of a source: the config file's section and the body of `PUT /source`."""

import re
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from voltcam_video.frame import Fit
from voltcam_video.light import Levels

SECRETS = "pass|pwd|token|secret|key|auth"
"""What the name of a query's secret has in it."""
PHOTOS = "photos:"


class SourceRequest(BaseModel):
    """Which source, and how to read it. What a source cannot do it ignores; `granted` says what came."""

    model_config = ConfigDict(frozen=True, extra="forbid", coerce_numbers_to_str=True)

    uri: str = Field(
        default="scene",
        min_length=1,
        description="scene (built in), a camera (0 or /dev/video0), a video file, a folder with images.txt, "
        "an .npz, a stream (rtsp://, http://, udp://...), replay:FILE, the events of a recording, or "
        "zmq+tcp://HOST:PORT, where programs send frames to, or ros1:TOPIC or ros2:TOPIC, images of ROS, or "
        "photos:FOLDER, photographs that move",
    )
    width: int | None = Field(
        default=None, ge=1, le=16384, description="pixels, asked of a camera or the scene; none: as it comes"
    )
    height: int | None = Field(
        default=None, ge=1, le=16384, description="pixels, asked of a camera or the scene; none: as it comes"
    )
    fps: float | None = Field(
        default=None, gt=0, le=10000, description="frames per second, asked of a camera or the scene"
    )
    pixel_format: str | None = Field(
        default=None,
        pattern=r"^[A-Za-z0-9 ]{4}$",
        examples=["MJPG"],
        description="four characters, asked of a camera: MJPG, YUYV, GREY...; none: OpenCV's choice",
    )
    pace: Literal["realtime", "fast"] = Field(
        default="realtime",
        description="recordings and the scene: realtime delivers each frame when it is due, stamped with the "
        "wall clock; fast delivers at once, with the recording's own times",
    )
    loop: bool = Field(default=False, description="start a recording again at its end, time running on")
    start_s: float = Field(
        default=0, ge=0, le=1e9, description="begin a recording so many seconds after its first frame"
    )
    rig: str | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="a name of your own: recordings of one rig, such as a stereo pair, play on one time "
        "line, frames of one recorded time at one moment",
    )
    fit: Fit = Field(
        default="crop",
        description="how frames of other proportions go into the camera's array: crop (edges lost), "
        "letterbox (black bars), stretch (out of proportion)",
    )
    levels: Levels = Field(
        default="auto",
        description="what grey levels are: light, as a DAVIS's frames have it, or video, coded for screens; "
        "auto: video of cameras, films, streams and single images, light of recordings and of the scene",
    )
    timeout_s: float = Field(
        default=5.0,
        gt=0,
        le=60,
        description="seconds without a frame after which a camera or stream has stalled",
    )

    @property
    def device(self) -> str | None:
        """The device file, of a camera."""
        if self.uri.isdecimal():
            return f"/dev/video{self.uri}"
        return self.uri if self.uri.startswith("/dev/") else None

    @property
    def inlet(self) -> str | None:
        """The ZeroMQ endpoint where it listens, of frames that programs send."""
        return self.uri.removeprefix("zmq+") if self.uri.startswith("zmq+") else None

    @property
    def ros1_topic(self) -> str | None:
        """The name of the topic, of images in ROS 1."""
        return self.uri.removeprefix("ros1:") if self.uri.startswith("ros1:") else None

    @property
    def ros2_topic(self) -> str | None:
        """The name of the topic, of images in ROS 2."""
        return self.uri.removeprefix("ros2:") if self.uri.startswith("ros2:") else None

    @property
    def photo_folder(self) -> Path | None:
        """The folder, of scenes made of photographs."""
        if not self.uri.startswith(PHOTOS):
            return None
        return Path(self.uri.removeprefix(PHOTOS).partition("?")[0])

    @property
    def photo_options(self) -> str:
        """What follows the folder: `seed=1&layers=4`, or nothing."""
        return self.uri.partition("?")[2] if self.uri.startswith(PHOTOS) else ""

    @property
    def path(self) -> Path | None:
        """The file or folder, of a recording."""
        topic = self.ros1_topic is not None or self.ros2_topic is not None
        made = self.uri == "scene" or self.photo_folder is not None
        apart = made or self.device is not None or "://" in self.uri or topic
        return None if apart else Path(self.uri)

    @property
    def shown(self) -> str:
        """The uri for messages and logs: a stream's password is left out."""
        uri = re.sub(r"(?<=://)([^/?#@:]*):[^/?#]*@", r"\1:***@", self.uri)
        return re.sub(rf"([?&][^=&#]*(?:{SECRETS})[^=&#]*=)[^&#]*", r"\1***", uri, flags=re.IGNORECASE)
