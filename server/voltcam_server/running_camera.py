"""A camera that runs: its source, parameters, transports and diagnosis."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from voltcam_simulator import Law, NoDeviceError, Parameters
from voltcam_video import Clock, SourceError

from .bias_panel import BiasPanel
from .camera_settings import EncodingName
from .camera_transports import CameraTransports, end_all
from .diagnosis.runner import DiagnosisRunner
from .emulator import Emulator
from .plan import Plan
from .problems import UsageError, one_line
from .status import Status
from .transports import Transport, WebSocketTransport


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
        bound = CameraTransports.of(plan, around.page, around.keys)
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
                transports=bound.all,
                clock=around.clock,
                on_status=lambda status: around.on_status(plan.name, status),
                on_failure=around.on_failure,
            )
        except NoDeviceError as error:
            end_all(bound.all)
            raise UsageError(one_line(error)) from None
        zmq, dv = bound.zeromq.endpoint, bound.dv.address if bound.dv else None
        return cls(plan, emulator, DiagnosisRunner(emulator, zmq), bound.websockets, zmq, bound.all, dv)

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
        end_all(self.transports)

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
