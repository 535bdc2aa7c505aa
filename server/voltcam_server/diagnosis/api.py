"""The diagnosis over REST and WebSocket, under /api/v1/diagnosis."""

import asyncio

from fastapi import APIRouter, Depends, HTTPException, Request, WebSocket
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict
from starlette.concurrency import run_in_threadpool

from ..access import SourceRules
from ..camera_api import POLICY_VIOLATION, chosen_of
from ..cameras import Cameras, NoCameraError
from ..request_body import body_of, read_model, refuses
from ..running_camera import RunningCamera
from .models import DiagnosisRequest, DiagnosisState

PUSH_PERIOD_S = 0.2


class VersionAnswer(BaseModel):
    """Which parameters hold."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    parameters_version: int
    """that of the packets made from now on"""


def diagnosis_routes(cameras: Cameras, rules: SourceRules) -> APIRouter:
    """Its routes; rules: what may be named as a reference."""
    api = APIRouter(prefix="/diagnosis")
    chosen = Depends(chosen_of(cameras))

    @api.get("", responses=refuses(404))
    async def get_diagnosis(camera: RunningCamera = chosen) -> DiagnosisState:
        """How far the diagnosis is, and its result when it is done."""
        return camera.diagnosis.state

    @api.post(
        "",
        status_code=201,
        openapi_extra=body_of(DiagnosisRequest),
        responses=refuses(400, 404, 409, 413, 422),
    )
    async def post_diagnosis(request: Request, camera: RunningCamera = chosen) -> DiagnosisState:
        """Begins one, from the parameters in force, against a recording or a second camera."""
        wanted = await read_model(request, DiagnosisRequest)
        if wanted.reference is not None:
            wanted = wanted.model_copy(update={"reference": str(rules.path(wanted.reference))})
        elif wanted.stream is not None:
            rules.stream(wanted.stream)
        return await run_in_threadpool(camera.diagnosis.start, wanted)

    @api.delete("", responses=refuses(404, 409))
    async def delete_diagnosis(camera: RunningCamera = chosen) -> DiagnosisState:
        """Ends it before it is done."""
        return await run_in_threadpool(camera.diagnosis.end)

    @api.post("/accept", responses=refuses(404, 409))
    async def accept(camera: RunningCamera = chosen) -> VersionAnswer:
        """What was found becomes the running parameters, between two frames and all at once."""
        return VersionAnswer(parameters_version=await run_in_threadpool(camera.diagnosis.accept))

    @api.post("/revert", responses=refuses(404, 409))
    async def revert(camera: RunningCamera = chosen) -> VersionAnswer:
        """Back to the parameters from before the last accept."""
        return VersionAnswer(parameters_version=await run_in_threadpool(camera.diagnosis.revert))

    @api.get(
        "/report",
        response_class=FileResponse,
        responses={200: {"content": {"text/html": {}}}, **refuses(404)},
    )
    async def report(camera: RunningCamera = chosen) -> FileResponse:
        """The page about what was found."""
        path = camera.diagnosis.report
        if path is None or not path.exists():
            raise HTTPException(404, "there is no report: it is there when a diagnosis is done")
        return FileResponse(path, media_type="text/html")

    @api.websocket("/progress")
    async def progress(websocket: WebSocket, camera: str | None = None) -> None:
        """The state as JSON text, now and after each change."""
        await websocket.accept()
        try:
            diagnosis = cameras.get(camera).diagnosis
        except NoCameraError as problem:
            await websocket.close(POLICY_VIOLATION, str(problem)[:120])
            return
        leaving = asyncio.create_task(_leave(websocket))
        seen = -1
        while not leaving.done():
            if diagnosis.changes != seen:
                seen = diagnosis.changes
                await websocket.send_text(diagnosis.state.model_dump_json())
            await asyncio.wait([leaving], timeout=PUSH_PERIOD_S)

    return api


async def _leave(websocket: WebSocket) -> None:
    while (await websocket.receive())["type"] != "websocket.disconnect":
        pass  # nothing that a client says matters here
