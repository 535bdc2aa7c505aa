"""REST and WebSocket under /api/v1, health, metrics, and the page at /.

Everything is of one origin: there are no CORS headers, and `access.Guard` refuses what a browser sends for a
page from elsewhere, and who has no token where there is one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fastapi import APIRouter, FastAPI, HTTPException, Request, Response, WebSocket
from fastapi.responses import JSONResponse, PlainTextResponse
from fastapi.staticfiles import StaticFiles
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.concurrency import run_in_threadpool

from voltcam_client.encodings import ENCODINGS, EVENT
from voltcam_client.errors import PacketError
from voltcam_client.formats import FormatError, RecordingError
from voltcam_client.packet import TOPIC_EVENTS, TOPIC_FRAMES
from voltcam_simulator import Law, Parameters
from voltcam_video import SourceError, SourceRequest

from .access import AccessError, Guard, SourceRules, Tokens, resolve_under, session_routes
from .access.session import Sessions
from .bodies import body_of, read_model, read_object, refusal
from .diagnosis import Diagnosis
from .diagnosis_api import diagnosis_routes
from .emulator import Emulator
from .metrics import CONTENT_TYPE, prometheus
from .problems import UsageError, one_line
from .recorder import RecordingStatus
from .settings import EncodingName
from .status import SourceStatus, Status
from .transports import WebSocketTransport

WEB = Path(__file__).parent / "web"
POLICY_VIOLATION = 1008  # WebSocket close code

# What the parts below raise, as HTTP says it. Anything else is an error of ours, 500.
REFUSALS: dict[type[Exception], int] = {
    UsageError: 409,
    RecordingError: 409,
    FormatError: 422,
    SourceError: 422,
    AccessError: 403,
}


class CameraAnswer(BaseModel):
    """The sensor, how it is simulated, where its packets are. parameters: the camera's own, at the start."""

    name: str
    width: int
    height: int
    law: Law
    seed: int
    encoding: EncodingName
    zmq: str
    parameters: Parameters


class ParametersAnswer(BaseModel):
    """parameters_version: that of the packets made with these parameters."""

    parameters: Parameters
    parameters_version: int


class RecordingRequest(BaseModel):
    """path: below the daemon's folder for recordings; its suffix is the format."""

    model_config = ConfigDict(extra="forbid")

    path: str = Field(min_length=1, max_length=4096)


@dataclass(frozen=True)
class Access:
    """hosts: names under which the daemon is reached. recordings: their folder. secure: it speaks https."""

    rules: SourceRules
    tokens: Tokens
    recordings: Path = Path()
    hosts: Sequence[str] = ()
    secure: bool = False


def create_app(
    emulator: Emulator,
    websockets: WebSocketTransport,
    camera: CameraAnswer,
    diagnosis: Diagnosis,
    access: Access,
) -> FastAPI:
    """The web application of a daemon."""
    sessions = Sessions()
    app = FastAPI(title="Voltcam", openapi_url="/api/v1/openapi.json", docs_url=None, redoc_url=None)
    app.add_middleware(Guard, hosts=access.hosts, tokens=access.tokens, sessions=sessions)
    for kind in REFUSALS:
        app.add_exception_handler(kind, _refuse)
    app.include_router(_control(emulator, camera, access), prefix="/api/v1")
    app.include_router(_streams(websockets, camera), prefix="/api/v1")
    app.include_router(diagnosis_routes(diagnosis, access.rules), prefix="/api/v1")
    app.include_router(session_routes(access.tokens, sessions, access.secure), prefix="/api/v1")
    app.include_router(_health(emulator))
    app.mount("/", StaticFiles(directory=WEB, html=True), name="page")
    return app


def _refuse(_: Request, error: Exception) -> JSONResponse:
    code = next(code for kind, code in REFUSALS.items() if isinstance(error, kind))
    return JSONResponse({"detail": one_line(error)}, code)


def _control(emulator: Emulator, camera: CameraAnswer, access: Access) -> APIRouter:
    api = APIRouter()

    @api.get("/camera")
    async def get_camera() -> CameraAnswer:
        return camera

    @api.get("/parameters")
    async def get_parameters() -> ParametersAnswer:
        return _answer(emulator.simulation.parameters)

    @api.get("/parameters/schema")
    async def get_parameters_schema() -> dict[str, Any]:
        return Parameters.model_json_schema()

    @api.patch("/parameters", openapi_extra=body_of(Parameters))
    async def patch_parameters(request: Request) -> ParametersAnswer:
        """Changes what is named, between two frames and all at once, or nothing."""
        changes = await read_object(request)
        try:
            wanted = emulator.simulation.parameters[0].changed(changes)
            await run_in_threadpool(emulator.simulation.prepare, wanted)
            return _answer(emulator.simulation.change(changes))
        except ValidationError as error:
            raise refusal(error, Parameters) from None

    @api.get("/source")
    async def get_source() -> SourceStatus:
        return emulator.source

    @api.put("/source", openapi_extra=body_of(SourceRequest))
    async def put_source(request: Request) -> SourceStatus:
        """Opens the new source; while that fails, the old one goes on."""
        wanted = await read_model(request, SourceRequest)
        await run_in_threadpool(emulator.look_at, access.rules.allowed(wanted))
        return emulator.source

    @api.post("/recording", status_code=201, openapi_extra=body_of(RecordingRequest))
    async def post_recording(request: Request) -> RecordingStatus:
        """Records events, and frames where the format holds them, until DELETE. Never overwrites a file."""
        wanted = await read_model(request, RecordingRequest)
        path = resolve_under([access.recordings], wanted.path)
        return await run_in_threadpool(emulator.record, str(path))

    @api.delete("/recording")
    async def delete_recording() -> RecordingStatus:
        """Finishes the file."""
        return await run_in_threadpool(emulator.end_recording)

    @api.get("/status")
    async def get_status() -> Status:
        return emulator.status

    return api


def _answer(current: tuple[Parameters, int]) -> ParametersAnswer:
    return ParametersAnswer(parameters=current[0], parameters_version=current[1])


def _streams(websockets: WebSocketTransport, camera: CameraAnswer) -> APIRouter:
    streams = APIRouter()

    @streams.websocket("/events")
    async def events(websocket: WebSocket, encoding: str = camera.encoding) -> None:
        try:
            check_encoding(encoding, camera.width, camera.height)
        except UsageError as problem:
            await websocket.accept()
            await websocket.close(POLICY_VIOLATION, str(problem)[:120])
        else:
            await websockets.serve(websocket, TOPIC_EVENTS, encoding)

    @streams.websocket("/frames")
    async def frames(websocket: WebSocket) -> None:
        await websockets.serve(websocket, TOPIC_FRAMES, "")

    return streams


def check_encoding(encoding: str, width: int, height: int) -> None:
    """Raises UsageError for an encoding that is none, or cannot hold the last pixel of such a camera."""
    if encoding not in ENCODINGS:
        raise UsageError(f"unknown encoding {encoding!r}: give one of {', '.join(ENCODINGS)}")
    try:
        ENCODINGS[encoding].encode(np.array([(0, width - 1, height - 1, True)], EVENT), 0)
    except PacketError as error:
        raise UsageError(one_line(error)) from None


def _health(emulator: Emulator) -> APIRouter:
    health = APIRouter(include_in_schema=False)

    @health.get("/healthz")
    async def healthz() -> dict[str, str]:
        if emulator.failure is not None:
            raise HTTPException(503, f"the daemon failed ({emulator.failure!r}): start it again")
        return {"status": "ok"}

    @health.get("/readyz")
    async def readyz(response: Response) -> dict[str, str]:
        """Ready while events go out, also where some are left out; else 503 and why."""
        state, reason = emulator.state
        response.status_code = 200 if state in ("running", "overloaded") else 503
        return {"status": state, "reason": reason}

    @health.get("/metrics")
    async def metrics() -> PlainTextResponse:
        return PlainTextResponse(prometheus(emulator.status), media_type=CONTENT_TYPE)

    return health
