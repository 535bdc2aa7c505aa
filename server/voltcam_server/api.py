"""The web application: REST and WebSocket under /api/v1, health, metrics, and the page at /.

Everything is of one origin: there are no CORS headers, and `access.Guard` refuses what a browser sends for a
page from elsewhere, and who has no token where there is one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fastapi import APIRouter, Depends, FastAPI, HTTPException, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, PlainTextResponse
from fastapi.security import HTTPBearer
from fastapi.staticfiles import StaticFiles
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException as StarletteHTTPException

from voltcam_client.formats import FormatError, RecordingError
from voltcam_video import SourceError

from .access import AccessError, Guard, SourceRules, Tokens, session_routes
from .access.session import Sessions
from .camera_api import camera_routes, stream_routes
from .cameras import Cameras, NoCameraError
from .diagnosis.api import diagnosis_routes
from .metrics import CONTENT_TYPE, prometheus
from .openapi import describe
from .problems import UsageError, one_line
from .reload import ReloadAnswer
from .request_body import refuses

WEB = Path(__file__).parent / "web"

# What the parts below raise, as HTTP says it. Anything else is an error of ours, 500.
REFUSALS: dict[type[Exception], int] = {
    NoCameraError: 404,
    UsageError: 409,
    RecordingError: 409,
    FormatError: 422,
    SourceError: 422,
    AccessError: 403,
    RequestValidationError: 422,
}


@dataclass(frozen=True)
class Access:
    """hosts: names under which the daemon is reached. recordings: their folder. secure: it speaks https."""

    rules: SourceRules
    tokens: Tokens
    recordings: Path = Path()
    least_free_bytes: int = 0
    hosts: Sequence[str] = ()
    secure: bool = False


def create_app(cameras: Cameras, access: Access, reload: Callable[[], ReloadAnswer]) -> FastAPI:
    """The web application of a daemon."""
    sessions = Sessions()
    app = FastAPI(title="Voltcam", openapi_url="/api/v1/openapi.json", docs_url=None, redoc_url=None)
    app.add_middleware(Guard, hosts=access.hosts, tokens=access.tokens, sessions=sessions)
    for kind in REFUSALS:
        app.add_exception_handler(kind, _refuse)
    for code in (404, 405):
        app.add_exception_handler(code, _not_so)
    # The guard looks at the token; this says in OpenAPI that one is needed.
    token = [Depends(HTTPBearer(auto_error=False))] if access.tokens else []
    for routes in (
        camera_routes(cameras, access.rules, access.recordings, access.least_free_bytes),
        diagnosis_routes(cameras, access.rules),
        _settings(reload),
    ):
        app.include_router(routes, prefix="/api/v1", dependencies=token, responses=refuses(401, 403, 422))
    app.include_router(stream_routes(cameras), prefix="/api/v1")
    app.include_router(session_routes(access.tokens, sessions, access.secure), prefix="/api/v1")
    app.include_router(_health(cameras))
    app.mount("/", StaticFiles(directory=WEB, html=True), name="page")
    describe(app)
    return app


def _refuse(_: Request, error: Exception) -> JSONResponse:
    code = next(code for kind, code in REFUSALS.items() if isinstance(error, kind))
    if isinstance(error, RequestValidationError):
        faults = (f"{'.'.join(map(str, fault['loc']))}: {fault['msg']}" for fault in error.errors())
        return JSONResponse({"detail": one_line("; ".join(faults))}, code)
    return JSONResponse({"detail": one_line(error)}, code)


def _not_so(request: Request, error: Exception) -> JSONResponse:
    """Nothing is there, or it is asked in a way that there is not: the page's files are looked for last."""
    assert isinstance(error, StarletteHTTPException)
    ways = {way.upper() for way in request.app.openapi()["paths"].get(request.url.path, {})}
    if not ways or request.method in ways:
        return JSONResponse({"detail": error.detail}, error.status_code, error.headers)
    allowed = ", ".join(sorted(ways))
    detail = f"{request.url.path} is not asked with {request.method[:20]}, but with {allowed}"
    return JSONResponse({"detail": detail}, 405, {"Allow": allowed})


def _settings(reload: Callable[[], ReloadAnswer]) -> APIRouter:
    settings = APIRouter()

    @settings.post("/reload", responses=refuses(409))
    async def post_reload() -> ReloadAnswer:
        """Reads the settings again, as SIGHUP does: cameras that are the same go on without a gap."""
        return await run_in_threadpool(reload)

    return settings


def _health(cameras: Cameras) -> APIRouter:
    health = APIRouter(include_in_schema=False)

    @health.get("/healthz")
    async def healthz() -> dict[str, str]:
        if cameras.failure is not None:
            raise HTTPException(503, f"the daemon failed ({cameras.failure!r}): start it again")
        return {"status": "ok"}

    @health.get("/readyz")
    async def readyz(response: Response) -> dict[str, str]:
        """Ready while events of all cameras go out, also where some are left out; else 503 and why."""
        state, reason = cameras.state
        response.status_code = 200 if state in ("running", "overloaded") else 503
        return {"status": state, "reason": reason}

    @health.get("/metrics")
    async def metrics() -> PlainTextResponse:
        return PlainTextResponse(prometheus(cameras), media_type=CONTENT_TYPE)

    return health
