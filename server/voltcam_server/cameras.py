"""The cameras of a daemon: each with its source, parameters, transports and diagnosis."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from voltcam_client.errors import VoltcamError
from voltcam_client.intrinsics import UNKNOWN_INTRINSICS, Intrinsics, read_intrinsics
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_client.samples import TOPIC_IMU, TOPIC_TRIGGERS
from voltcam_simulator import Camera, Law, NoDeviceError, Parameters
from voltcam_video import Clock, SourceError

from .bias_panel import BiasPanel
from .camera_settings import CameraSettings, EncodingName, check_encoding
from .diagnosis import DiagnosisRunner
from .emulator import Emulator
from .problems import UsageError, one_line
from .settings import Settings
from .status import State, Status
from .transports import (
    DvTransport,
    FoxgloveTransport,
    Ros2Transport,
    Transport,
    UdpTransport,
    WebSocketTransport,
    ZeroMQTransport,
)

SERIAL = "EMU00001"
WORST_FIRST: tuple[State, ...] = ("stalled", "source lost", "starting", "ended", "overloaded", "running")


class NoCameraError(ValueError):
    """There is no camera of that name."""


class CameraAnswer(BaseModel):
    """The sensor, how it is simulated, and where its packets are."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    name: str
    """for ?camera=NAME"""

    width: int
    """pixels"""

    height: int
    """pixels"""

    law: Law
    """when a pixel fires"""

    seed: int
    """of its noise"""

    encoding: EncodingName
    """of event packets, where none is asked for"""

    zmq: str
    """where its packets are"""

    dv: str | None
    """HOST:PORT of its DV streams; null: there are none"""

    ros2: str | None
    """namespace of its topics in ROS 2; null: there are none"""

    parameters: Parameters
    """at the start"""


@dataclass(frozen=True)
class Plan:
    """A camera as the settings have it, its file read. serial: by which DV's programs know it."""

    name: str
    settings: CameraSettings
    camera: Camera
    serial: str = SERIAL


def plans_of(settings: Settings) -> list[Plan]:
    """What is to run. Raises UsageError for a camera file, or an encoding, that cannot be."""
    plans = []
    for name, each in settings.each().items():
        try:
            camera = each.load_camera()
            check_encoding(each.encoding, camera.width, camera.height)
        except UsageError as error:
            raise UsageError(f"cameras.{name}: {error}" if settings.cameras else str(error)) from None
        if settings.cameras:
            camera = camera.model_copy(update={"name": name})
        plans.append(Plan(camera.name, each, camera, name if settings.cameras else SERIAL))
    return plans


@dataclass(frozen=True)
class Surroundings:
    """What all cameras of a daemon share. page: where their WebSockets are. keys: of ZeroMQ's encryption."""

    page: str
    keys: Path | None
    clock: Clock
    on_status: Callable[[str, Status], None]
    on_failure: Callable[[], None]


@dataclass(frozen=True, eq=False)
class RunningCamera:
    """A camera with all that belongs to it. `start` it, then `stop` it, once.

    zmq, dv: where its packets are.
    """

    plan: Plan
    emulator: Emulator
    diagnosis: DiagnosisRunner
    websockets: WebSocketTransport
    zmq: str
    transports: Sequence[Transport] = ()
    dv: str | None = None

    @classmethod
    def of(cls, plan: Plan, around: Surroundings) -> "RunningCamera":
        """Bound to its endpoints, and not yet looking. Raises UsageError."""
        settings = plan.settings
        zeromq = ZeroMQTransport(settings.zmq, settings.encoding, around.keys)
        websockets = WebSocketTransport(around.page)
        transports: list[Transport] = [zeromq, websockets]
        try:
            dv = _dv_transport(plan)
            transports += [dv] if dv is not None else []
            if settings.udp != "off":
                transports.append(UdpTransport(settings.udp, plan.camera.width, plan.camera.height))
            if settings.foxglove != "off":
                size = (plan.camera.width, plan.camera.height)
                transports.append(FoxgloveTransport(settings.foxglove, plan.name, *size))
            transports += [_ros2_transport(plan)] if settings.ros2 != "off" else []
        except UsageError:
            for transport in transports:
                transport.stop()
            raise
        try:
            emulator = Emulator(
                plan.camera,
                settings.source,
                law=settings.law,
                device=settings.device,
                seed=settings.seed,
                upsample=settings.upsample,
                packets=settings.packets,
                overload=settings.overload,
                davis=settings.davis,
                transports=transports,
                clock=around.clock,
                on_status=lambda status: around.on_status(plan.name, status),
                on_failure=around.on_failure,
            )
        except NoDeviceError as error:
            for transport in transports:
                transport.stop()
            raise UsageError(one_line(error)) from None
        diagnosis = DiagnosisRunner(emulator, zeromq.endpoint)
        return cls(
            plan, emulator, diagnosis, websockets, zeromq.endpoint, transports, dv.address if dv else None
        )

    @cached_property
    def biases(self) -> BiasPanel:
        """What drivers of a DAVIS set: the camera file is the camera at the usual biases."""
        return BiasPanel(self.plan.camera.parameters)

    def start(self) -> None:
        """Open the source, and go. Raises UsageError; `stop` is due in any case."""
        try:
            self.emulator.start()
        except SourceError as error:
            raise UsageError(one_line(error)) from None
        for transport in self.transports:
            transport.start()

    def stop(self) -> None:
        """End it; what takes long is left, see `Emulator.busy`."""
        self.diagnosis.stop()
        self.emulator.stop()
        for transport in self.transports:
            transport.stop()

    @property
    def name(self) -> str:
        return self.plan.name

    @property
    def addresses(self) -> dict[str, str]:
        """Of its transports, by name, as programs of theirs are told them."""
        found = {transport.name: transport.status.address for transport in self.transports}
        found |= {} if self.dv is None else {"dv": self.dv}
        return found | ({"ros2": self.plan.settings.ros2} if "ros2" in found else {})

    @property
    def answer(self) -> CameraAnswer:
        camera, settings = self.plan.camera, self.plan.settings
        return CameraAnswer(
            name=self.name,
            width=camera.width,
            height=camera.height,
            law=settings.law,
            seed=settings.seed,
            encoding=settings.encoding,
            zmq=self.zmq,
            dv=self.dv,
            ros2=settings.ros2 if settings.ros2 != "off" else None,
            parameters=camera.parameters,
        )


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


class Cameras:
    """Those that run, in the order of the settings. The first is meant where none is named."""

    def __init__(self, running: Iterable[RunningCamera] = ()) -> None:
        self._running = tuple(running)  # replaced, never changed: any thread may go through it

    def __iter__(self) -> Iterator[RunningCamera]:
        return iter(self._running)

    def get(self, name: str | None = None) -> RunningCamera:
        """A camera by name. Raises NoCameraError."""
        for camera in self._running:
            if name in (None, camera.name):
                return camera
        names = ", ".join(camera.name for camera in self._running)
        raise NoCameraError(
            f"there is no camera {name!r}, only {names or 'none'}: GET /api/v1/cameras lists them"
        )

    def replace(self, running: Iterable[RunningCamera]) -> None:
        """These, and no others."""
        self._running = tuple(running)

    @property
    def state(self) -> tuple[State, str]:
        """That of the camera which is worst, with its name in the reason where there are several."""
        states = [(*camera.emulator.state, camera.name) for camera in self]
        if not states:
            return "starting", "no camera runs"
        state, reason, name = min(states, key=lambda each: WORST_FIRST.index(each[0]))
        return state, f"{name}: {reason}" if len(states) > 1 and reason else reason

    @property
    def failure(self) -> Exception | None:
        """An error of ours that has ended a thread."""
        return next((camera.emulator.failure for camera in self if camera.emulator.failure), None)

    @property
    def busy(self) -> bool:
        """After `stop`: whether something goes on that cannot be ended."""
        return any(camera.emulator.busy for camera in self)

    def start(self) -> None:
        """Start all of them, at the same time. Raises UsageError of the first that cannot."""
        with ThreadPoolExecutor(max(1, len(self._running))) as pool:
            list(pool.map(RunningCamera.start, self._running))

    def stop(self) -> None:
        """End all of them, at the same time."""
        with ThreadPoolExecutor(max(1, len(self._running))) as pool:
            list(pool.map(RunningCamera.stop, self._running))
