"""The cameras of a daemon: each with its source, parameters, transports and diagnosis."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from voltcam_simulator import Camera, Law, NoDeviceError, Parameters
from voltcam_video import Clock, SourceError

from .camera_settings import CameraSettings, EncodingName, check_encoding
from .diagnosis import DiagnosisRunner
from .emulator import Emulator
from .problems import UsageError, one_line
from .settings import Settings
from .status import State, Status
from .transports import Transport, WebSocketTransport, ZeroMQTransport

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

    parameters: Parameters
    """at the start"""


@dataclass(frozen=True)
class Plan:
    """A camera as the settings have it, its file read."""

    name: str
    settings: CameraSettings
    camera: Camera


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
        plans.append(Plan(camera.name, each, camera))
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
    """A camera with all that belongs to it; zmq: where its packets are. `start` it, then `stop` it, once."""

    plan: Plan
    emulator: Emulator
    diagnosis: DiagnosisRunner
    websockets: WebSocketTransport
    zmq: str
    transports: Sequence[Transport] = ()

    @classmethod
    def of(cls, plan: Plan, around: Surroundings) -> "RunningCamera":
        """Bound to its endpoint, and not yet looking. Raises UsageError."""
        settings = plan.settings
        zeromq = ZeroMQTransport(settings.zmq, settings.encoding, around.keys)
        websockets = WebSocketTransport(around.page)
        transports: list[Transport] = [zeromq, websockets]
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
                transports=transports,
                clock=around.clock,
                on_status=lambda status: around.on_status(plan.name, status),
                on_failure=around.on_failure,
            )
        except NoDeviceError as error:
            raise UsageError(one_line(error)) from None
        diagnosis = DiagnosisRunner(emulator, zeromq.endpoint)
        return cls(plan, emulator, diagnosis, websockets, zeromq.endpoint, transports)

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
            parameters=camera.parameters,
        )


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
