"""Which transports a camera has, by its settings: bound to their endpoints, and not yet sending."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from voltcam_client.errors import VoltcamError
from voltcam_client.intrinsics import UNKNOWN_INTRINSICS, Intrinsics, read_intrinsics
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_client.samples import TOPIC_IMU, TOPIC_TRIGGERS

from .camera_settings import CameraSettings
from .plan import Plan
from .problems import UsageError, one_line
from .transports import (
    DvTransport,
    FoxgloveTransport,
    Ros2Transport,
    Transport,
    UdpTransport,
    WebSocketTransport,
    ZeroMQTransport,
)


@dataclass(frozen=True, eq=False)
class CameraTransports:
    """All of them, and by name those that say more of themselves than a `Transport` does."""

    zeromq: ZeroMQTransport
    websockets: WebSocketTransport
    dv: DvTransport | None
    all: list[Transport]

    @classmethod
    def of(cls, plan: Plan, page: str, keys: Path | None) -> "CameraTransports":
        """page: where WebSockets are. keys: of ZeroMQ's encryption. Raises UsageError, with none bound."""
        settings, size = plan.settings, (plan.camera.width, plan.camera.height)
        zeromq = ZeroMQTransport(settings.zmq, settings.encoding, keys)
        websockets = WebSocketTransport(page)
        transports: list[Transport] = [zeromq, websockets]
        try:
            dv = _dv_transport(plan)
            transports += [dv] if dv is not None else []
            transports += [UdpTransport(settings.udp, *size)] if settings.udp != "off" else []
            if settings.foxglove != "off":
                transports.append(FoxgloveTransport(settings.foxglove, plan.name, *size))
            transports += [_ros2_transport(plan)] if settings.ros2 != "off" else []
        except UsageError:
            end_all(transports)
            raise
        return cls(zeromq, websockets, dv, transports)


def end_all(transports: Iterable[Transport]) -> None:
    """End them."""
    for transport in transports:
        transport.stop()


def _dv_transport(plan: Plan) -> DvTransport | None:
    """Raises UsageError."""
    if plan.settings.dv == "off":
        return None
    width, height = plan.camera.width, plan.camera.height
    return DvTransport(plan.settings.dv, width, height, plan.serial, tuple(_topics(plan.settings)))


def _ros2_transport(plan: Plan) -> Ros2Transport:
    """Raises UsageError."""
    settings = plan.settings
    sizes = {
        TOPIC_EVENTS: settings.packets.packet_bytes * (2 if settings.ros2_messages == "array" else 1),
        TOPIC_FRAMES: plan.camera.width * plan.camera.height,
        TOPIC_IMU: 400,
    }
    largest = {topic: sizes[topic] for topic in _topics(settings) if topic in sizes}
    intrinsics = _intrinsics(settings.camera_info, (plan.camera.width, plan.camera.height))
    return Ros2Transport(settings.ros2, settings.encoding, largest, settings.ros2_messages, intrinsics)


def _intrinsics(path: Path | None, size: tuple[int, int]) -> Intrinsics:
    """Raises UsageError for a file that cannot be read, and for a camera of another size."""
    if path is None:
        return UNKNOWN_INTRINSICS
    try:
        intrinsics = read_intrinsics(path)
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror}: check the name and its rights") from None
    except VoltcamError as error:
        raise UsageError(one_line(error)) from None
    if intrinsics.size != size:
        (w, h), (width, height) = intrinsics.size or (0, 0), size
        raise UsageError(
            f"{path} is of {w} x {h} pixels, and the camera has {width} x {height}: calibrate that one"
        )
    return intrinsics


def _topics(settings: CameraSettings) -> list[bytes]:
    """What a camera gives."""
    davis = settings.davis
    there = {
        TOPIC_EVENTS: True,
        TOPIC_FRAMES: davis.frames != "off",
        TOPIC_TRIGGERS: davis.triggers_hz > 0,
        TOPIC_IMU: davis.imu_hz > 0,
    }
    return [topic for topic, is_there in there.items() if is_there]
