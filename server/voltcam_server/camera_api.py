"""REST and WebSocket of one camera: parameters, source, recording, status, events and frames.

All take `?camera=NAME`; without it they are about the first.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response, WebSocket
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.concurrency import run_in_threadpool

from voltcam_client.formats import SUFFIXES
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_simulator import Parameters, camera_names
from voltcam_simulator.biases import Biases, BiasSet
from voltcam_video import SourceRequest

from .access import SourceRules, resolve_under
from .camera_settings import check_encoding
from .cameras import Cameras, NoCameraError
from .problems import UsageError
from .recorder import RecordingPlan, RecordingStatus
from .request_body import body_of, camera_body, read_camera, read_model, read_object, refusal, refuses
from .running_camera import CameraAnswer, RunningCamera
from .status import SourceStatus, State, Status

POLICY_VIOLATION = 1008  # WebSocket close code
YAML: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/yaml": {"schema": {"type": "object"}}}}
}
SUFFIX_PATTERN = rf"\S({'|'.join(map(re.escape, SUFFIXES))})$"


class CameraListAnswer(BaseModel):
    """A camera of the daemon and how it is."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    name: str
    """for ?camera=NAME"""

    width: int
    """pixels"""

    height: int
    """pixels"""

    zmq: str
    """where its packets are"""

    state: State
    """how it is"""

    reason: str
    """why, in one line, where it is not running"""


class ParametersAnswer(BaseModel):
    """Parameters, and which they are."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    parameters: Parameters
    """all of them"""

    parameters_version: int
    """that of the packets made with them"""


class RecordingRequest(BaseModel):
    """What to record into."""

    model_config = ConfigDict(use_attribute_docstrings=True, extra="forbid")

    path: str = Field(min_length=1, max_length=4096, json_schema_extra={"pattern": SUFFIX_PATTERN})
    """below the daemon's folder for recordings; its suffix is the format"""

    rotate_bytes: int | None = Field(default=None, ge=1_000_000)
    """a file of so many bytes is ended, and NAME-002 and so on go on"""

    rotate_s: float | None = Field(default=None, ge=1)
    """the same, of so many seconds"""


def chosen_of(cameras: Cameras) -> Callable[..., Any]:
    """The dependency that gives a route its camera."""

    async def chosen(
        camera: Annotated[str | None, Query(max_length=64, description="none: the first")] = None,
    ) -> RunningCamera:
        return cameras.get(camera)

    return chosen


def camera_routes(cameras: Cameras, rules: SourceRules, recordings: Path, least_free_bytes: int) -> APIRouter:
    """What is asked and changed."""
    api = APIRouter()
    chosen = Depends(chosen_of(cameras))

    @api.get("/cameras")
    async def get_cameras() -> list[CameraListAnswer]:
        """All cameras of the daemon."""
        return [_listed(camera) for camera in cameras]

    @api.get("/camera", responses=refuses(404))
    async def get_camera(camera: RunningCamera = chosen) -> CameraAnswer:
        """The sensor, how it is simulated, and where its packets are."""
        return camera.answer

    @api.get("/parameters", responses=refuses(404))
    async def get_parameters(camera: RunningCamera = chosen) -> ParametersAnswer:
        """All parameters that hold now, nested by effect, and their version."""
        return _answer(camera.emulator.simulation.parameters)

    @api.get("/parameters/schema")
    async def get_parameters_schema() -> dict[str, Any]:
        """JSON schema of all parameters: unit, limits, default, meaning and source of each."""
        return Parameters.model_json_schema()

    @api.patch("/parameters", openapi_extra=body_of(Parameters), responses=refuses(400, 404, 413, 422))
    async def patch_parameters(request: Request, camera: RunningCamera = chosen) -> ParametersAnswer:
        """Changes what is named, between two frames and all at once, or nothing."""
        changes = await read_object(request)
        simulation = camera.emulator.simulation
        try:
            wanted = simulation.parameters[0].changed(changes)
            await run_in_threadpool(simulation.prepare, wanted)
            return _answer(simulation.change(changes))
        except ValidationError as error:
            raise refusal(error, Parameters) from None

    @api.get("/parameters/file", response_class=Response, responses={**YAML, **refuses(404)})
    async def get_parameters_file(camera: RunningCamera = chosen) -> Response:
        """The camera with the parameters that hold now, as a camera file."""
        now = camera.plan.camera.model_copy(update={"parameters": camera.emulator.simulation.parameters[0]})
        return Response(now.to_yaml(), media_type="application/yaml")

    @api.put("/parameters/file", openapi_extra=camera_body(), responses=refuses(400, 404, 413, 422))
    async def put_parameters_file(request: Request, camera: RunningCamera = chosen) -> ParametersAnswer:
        """Takes all parameters of a camera file; the sensor keeps its size."""
        wanted = await read_camera(request)
        simulation = camera.emulator.simulation
        await run_in_threadpool(simulation.prepare, wanted.parameters)
        return _answer(simulation.change(wanted.parameters.model_dump()))

    @api.get("/biases", response_model=Biases, responses=refuses(404))
    async def get_biases(camera: RunningCamera = chosen) -> BiasSet:
        """The biases of a DAVIS that gives the parameters of now, named as drivers name them."""
        return camera.biases.now(camera.emulator.simulation.parameters[0])

    @api.patch(
        "/biases",
        response_model=Biases,
        openapi_extra=body_of(Biases),
        responses=refuses(400, 404, 413, 422),
    )
    async def patch_biases(request: Request, camera: RunningCamera = chosen) -> BiasSet:
        """Changes the biases that are named, and the parameters that depend on them, at once, or nothing."""
        changes = await read_object(request)
        simulation = camera.emulator.simulation
        try:
            biases, change = camera.biases.wanted(simulation.parameters[0], changes)
            await run_in_threadpool(simulation.prepare, simulation.parameters[0].changed(change))
            simulation.change(change)
        except ValidationError as error:
            raise refusal(error, Biases) from None
        camera.biases.set(biases)
        return biases

    @api.get("/presets")
    async def get_presets() -> dict[str, Parameters]:
        """The parameters of the cameras that have names."""
        return {name: Parameters.of(name) for name in camera_names()}

    @api.get("/source", responses=refuses(404))
    async def get_source(camera: RunningCamera = chosen) -> SourceStatus:
        """What the camera looks at: what was asked for, and what came of it."""
        return camera.emulator.source

    @api.put("/source", openapi_extra=body_of(SourceRequest), responses=refuses(400, 404, 409, 413, 422))
    async def put_source(request: Request, camera: RunningCamera = chosen) -> SourceStatus:
        """Opens the new source; while that fails, the old one goes on."""
        wanted = await read_model(request, SourceRequest)
        allowed = rules.allowed(wanted, camera.plan.settings.source.uri)
        await run_in_threadpool(camera.emulator.look_at, allowed)
        return camera.emulator.source

    @api.post(
        "/recording",
        status_code=201,
        openapi_extra=body_of(RecordingRequest),
        responses=refuses(400, 404, 409, 413, 422),
    )
    async def post_recording(request: Request, camera: RunningCamera = chosen) -> RecordingStatus:
        """Records events, and frames where the format holds them, until DELETE. Never overwrites a file."""
        wanted = await read_model(request, RecordingRequest)
        path = resolve_under([recordings], wanted.path)
        plan = RecordingPlan(path, wanted.rotate_bytes, wanted.rotate_s, least_free_bytes)
        return await run_in_threadpool(camera.emulator.recordings.begin, plan)

    @api.delete("/recording", responses=refuses(404, 409))
    async def delete_recording(camera: RunningCamera = chosen) -> RecordingStatus:
        """Finishes the file. What takes over 5 s goes on: `ending` of the status tells until when."""
        return await run_in_threadpool(camera.emulator.recordings.end)

    @api.get("/status", responses=refuses(404))
    async def get_status(camera: RunningCamera = chosen) -> Status:
        """How the camera is: state, load, rates, latency, losses, transports, recording."""
        return camera.emulator.status

    return api


def stream_routes(cameras: Cameras) -> APIRouter:
    """What is streamed."""
    streams = APIRouter()

    @streams.websocket("/events")
    async def events(
        websocket: WebSocket,
        camera: str | None = None,
        encoding: str | None = None,
        bundle_ms: Annotated[float, Query(ge=0, le=1000)] = 0,
    ) -> None:
        try:
            of = cameras.get(camera)
            plan = of.plan
            encoding = encoding if encoding is not None else plan.settings.encoding
            check_encoding(encoding, plan.camera.width, plan.camera.height)
        except (UsageError, NoCameraError) as problem:
            await _refuse(websocket, problem)
        else:
            await of.websockets.serve(websocket, TOPIC_EVENTS, encoding, bundle_ms)

    @streams.websocket("/frames")
    async def frames(websocket: WebSocket, camera: str | None = None) -> None:
        try:
            of = cameras.get(camera)
        except NoCameraError as problem:
            await _refuse(websocket, problem)
        else:
            await of.websockets.serve(websocket, TOPIC_FRAMES, "")

    return streams


async def _refuse(websocket: WebSocket, problem: Exception) -> None:
    await websocket.accept()
    await websocket.close(POLICY_VIOLATION, str(problem)[:120])


def _answer(current: tuple[Parameters, int]) -> ParametersAnswer:
    return ParametersAnswer(parameters=current[0], parameters_version=current[1])


def _listed(camera: RunningCamera) -> CameraListAnswer:
    state, reason = camera.emulator.state
    sensor = camera.plan.camera
    return CameraListAnswer(
        name=camera.name, width=sensor.width, height=sensor.height, zmq=camera.zmq, state=state, reason=reason
    )
