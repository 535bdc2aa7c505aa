"""What the server's tests run: small emulators in process, `voltcam serve` itself."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import msgpack
import numpy as np
import pytest
import uvicorn
from fastapi import FastAPI
from numpy.typing import NDArray

from voltcam_client.packet import (
    EVENT,
    TOPIC_EVENTS,
    TOPIC_FRAMES,
    TOPIC_STATUS,
    FrameMessage,
    Packet,
    decode_frame,
    decode_packet,
)
from voltcam_client.samples import (
    TOPIC_IMU,
    TOPIC_TRIGGERS,
    SamplesMessage,
    decode_imu,
    decode_triggers,
)
from voltcam_server.access import AccessSettings, SourceRules, Tokens
from voltcam_server.api import Access, create_app
from voltcam_server.camera_settings import CameraSettings
from voltcam_server.cameras import Cameras
from voltcam_server.diagnosis.runner import DiagnosisRunner
from voltcam_server.emulator import Emulator
from voltcam_server.mailbox import Arrival
from voltcam_server.messages import Message
from voltcam_server.plan import Plan
from voltcam_server.recorder import RecordingPlan
from voltcam_server.recording_file import RecordingFile
from voltcam_server.reload import ReloadAnswer
from voltcam_server.running_camera import RunningCamera
from voltcam_server.transports import Transport, TransportStatus, WebSocketTransport
from voltcam_simulator import Camera, Parameters
from voltcam_video import Frame, SourceRequest

NO_ZMQ = "tcp://127.0.0.1:5560"  # as a camera says; nobody is there
PATIENCE_S = 30.0  # how long a test waits for something that happens in well under a second
SCENE = SourceRequest(uri="scene", fps=100, width=48, height=32, fit="stretch")


def tiny(**changes: Any) -> Camera:
    """A camera of 24 x 16 pixels."""
    return Camera(name="tiny", width=24, height=16, parameters=Parameters().changed(changes))


def moving_frames(count: int, camera: Camera, seed: int = 0) -> NDArray[np.uint8]:
    """Random brightness, smooth in time: some events per pixel and frame."""
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0, 2 * np.pi, (camera.height, camera.width))
    return np.stack([(128 + 100 * np.sin(phase + 0.3 * i)).astype(np.uint8) for i in range(count)])


def save_frames(path: Path, frames: NDArray[np.uint8], period_us: int = 10_000, start_us: int = 0) -> str:
    np.savez(path, frames=frames, t_us=start_us + period_us * np.arange(len(frames)))
    return str(path)


def arrival(
    image: NDArray[Any], t_us: int, *, cut: bool = False, paced: bool = True, missed: int = 0
) -> Arrival:
    return Arrival(Frame(image, t_us), "crop", time.monotonic(), cut, paced, missed)


def until(condition: Callable[[], object], what: str) -> None:
    """Wait for a condition that nothing announces."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"not within {PATIENCE_S} s: {what}"
        time.sleep(0.01)


class Listener(Transport):
    """A transport that keeps what it gets, as a subscriber would decode it."""

    name = "listener"

    def __init__(self) -> None:
        super().__init__()
        self.packets: list[Packet] = []
        self.frames: list[FrameMessage] = []
        self.imu: list[SamplesMessage] = []
        self.triggers: list[SamplesMessage] = []
        self.statuses: list[dict[str, Any]] = []
        self._heard = threading.Condition()

    def wait(self, condition: Callable[["Listener"], object]) -> None:
        """Until the condition holds of what has come."""
        with self._heard:
            assert self._heard.wait_for(lambda: condition(self), PATIENCE_S), "it did not come"

    @property
    def events(self) -> NDArray[np.void]:
        return np.concatenate([np.empty(0, EVENT), *(packet.events for packet in self.packets)])

    @property
    def status(self) -> TransportStatus:
        return TransportStatus(address="here", packets_sent=len(self.packets), packets_dropped=0)

    def _send(self, message: Message) -> None:
        with self._heard:
            if message.topic == TOPIC_EVENTS:
                header, buffer = message.parts("libcaer")
                self.packets.append(decode_packet(header, buffer))
            if message.topic == TOPIC_FRAMES:
                header, buffer = message.parts("")
                self.frames.append(decode_frame(header, buffer))
            if message.topic == TOPIC_IMU:
                self.imu.append(decode_imu(*message.parts("")))
            if message.topic == TOPIC_TRIGGERS:
                self.triggers.append(decode_triggers(*message.parts("")))
            if message.topic == TOPIC_STATUS:
                self.statuses.append(msgpack.unpackb(message.parts("")[0]))
            self._heard.notify_all()

    def _dropped(self, message: Message) -> None:
        raise AssertionError("the listener did not keep up")

    def _close(self) -> None:
        pass


def slow_disk(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """From now on recordings write nothing until this is set."""
    go, write = threading.Event(), RecordingFile.write

    def slow(file: RecordingFile, *what: Any) -> None:
        assert go.wait(PATIENCE_S)
        write(file, *what)

    monkeypatch.setattr(RecordingFile, "write", slow)
    return go


def gap_free(listener: Listener) -> bool:
    return [packet.seq for packet in listener.packets] == list(range(len(listener.packets)))


def in_order(listener: Listener) -> bool:
    return bool((np.diff(listener.events["t"]) >= 0).all())


@contextlib.contextmanager
def emulating(
    source: SourceRequest, camera: Camera | None = None, **settings: Any
) -> Iterator[tuple[Emulator, Listener]]:
    """A running emulator and its listener, which keeps all that it hears."""
    listener = Listener()
    with started(Emulator(camera or tiny(), source, transports=[listener], **settings), listener) as emulator:
        yield emulator, listener


@contextlib.contextmanager
def started(emulator: Emulator, transport: Transport) -> Iterator[Emulator]:
    """The emulator and its transport run; it must not have failed at the end."""
    transport.start()
    try:
        emulator.start()
        yield emulator
        if emulator.failure is not None:
            raise emulator.failure
    finally:
        emulator.stop()
        transport.stop()


def open_access(recordings: Path = Path("/"), **settings: Any) -> Access:
    """Everything may be named, as on a machine of one's own."""
    rules = AccessSettings(
        **{"source_folders": [Path("/")], "source_urls": ["*"], "streams": ["*"]} | settings
    )
    return Access(SourceRules(rules), Tokens([]), recordings)


def running(emulator: Emulator, websockets: WebSocketTransport, **parts: Any) -> RunningCamera:
    """The emulator as a camera of a daemon's; nobody is at its ZeroMQ endpoint."""
    settings = CameraSettings(source=SCENE, zmq=NO_ZMQ)
    given = {"diagnosis": DiagnosisRunner(emulator, NO_ZMQ), "zmq": NO_ZMQ} | parts
    plan = Plan(emulator.camera.name, settings, emulator.camera)
    return RunningCamera(plan, emulator, websockets=websockets, **given)


def app_of(*cameras: RunningCamera, access: Access | None = None) -> FastAPI:
    """The web application over cameras that run."""
    return create_app(Cameras(cameras), access or open_access(), ReloadAnswer)


@contextlib.contextmanager
def web_server(app: FastAPI) -> Iterator[str]:
    """The app on a free port, by uvicorn as the daemon runs it; yields HOST:PORT."""
    server = uvicorn.Server(
        uvicorn.Config(
            app,
            port=0,
            log_level="warning",
            lifespan="off",
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=1,
        )
    )
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        until(lambda: server.started, "the web server starts")
        yield f"127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()


LIVELY = {"comparator": {"theta_on": 0.3, "theta_off": 0.3}}


def record(path: Path, source: SourceRequest, camera: Camera, **settings: Any) -> None:
    """Some frames, with a change of parameters on the way."""
    with emulating(source, camera, **settings) as (emulator, listener):
        listener.wait(lambda it: len(it.frames) > 20)
        emulator.recordings.begin(RecordingPlan(path))
        count = len(listener.frames)  # the next few may be of before the recording: it is heard of later
        listener.wait(lambda it: len(it.frames) > count + 10)
        emulator.simulation.change({"temperature_c": 60, "leak_noise": {"k6": 1e-5}})
        listener.wait(lambda it: len(it.frames) > count + 40)
        emulator.recordings.end()


def film(folder: Path, camera: Camera) -> SourceRequest:
    """8-bit frames, again and again."""
    uri = save_frames(folder / "film.npz", moving_frames(60, camera))
    return SourceRequest(uri=uri, loop=True)


@dataclass
class Api:
    emulator: Emulator
    listener: Listener
    http: httpx.Client
    address: str

    def refused(self, code: int, method: str, path: str, **request: Any) -> str:
        """The reason, which is one line."""
        response = self.http.request(method, path, **request)
        assert response.status_code == code, response.text
        detail = response.json()["detail"]
        assert isinstance(detail, str)
        assert "\n" not in detail
        return detail


@contextlib.contextmanager
def serving() -> Iterator[Api]:
    """REST of a small camera that looks at the scene, at a real web server."""
    with (
        emulating(SCENE, tiny()) as (emulator, listener),
        web_server(app_of(running(emulator, WebSocketTransport("here")))) as address,
        httpx.Client(base_url=f"http://{address}/api/v1/", trust_env=False) as http,
    ):
        yield Api(emulator, listener, http, address)
