"""Sessions: a browser exchanges its token for a cookie, since it can send no header with a WebSocket."""

import secrets
import threading
import time
from collections import OrderedDict

from fastapi import APIRouter, HTTPException, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from ..request_body import body_of, read_model, refuses
from .tokens import Role, Tokens

COOKIE = "voltcam_session"
SESSION_S = 12 * 3600
MOST_SESSIONS = 100  # the oldest ends for a new one


class SessionRequest(BaseModel):
    """Who asks."""

    model_config = ConfigDict(use_attribute_docstrings=True, extra="forbid")

    token: str = Field(min_length=1, max_length=1000)
    """of the daemon's file or environment"""


class SessionAnswer(BaseModel):
    """What the caller may do."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    role: Role | None
    """view or control; null: nothing but begin a session"""

    needs_token: bool
    """whether the daemon has tokens"""


class Sessions:
    """What the cookies in use allow."""

    def __init__(self) -> None:
        self._open: OrderedDict[str, tuple[Role, float]] = OrderedDict()
        self._lock = threading.Lock()

    def begin(self, role: Role) -> str:
        """A new cookie's value."""
        with self._lock:
            cookie = secrets.token_urlsafe(32)
            self._open[cookie] = role, time.monotonic() + SESSION_S
            while len(self._open) > MOST_SESSIONS:
                self._open.popitem(last=False)
            return cookie

    def role_of(self, cookie: str) -> Role | None:
        """What a cookie allows now."""
        with self._lock:
            role, until_s = self._open.get(cookie, (None, 0.0))
            return role if time.monotonic() < until_s else None

    def end(self, cookie: str) -> None:
        with self._lock:
            self._open.pop(cookie, None)


def session_routes(tokens: Tokens, sessions: Sessions, secure: bool) -> APIRouter:
    """`/session`; secure: the cookie is for https only."""
    api = APIRouter(prefix="/session")

    @api.get("", responses=refuses(403))
    async def get_session(request: Request) -> SessionAnswer:
        """What the caller may do, and whether a token is needed for more."""
        return SessionAnswer(role=request.scope.get("voltcam_role"), needs_token=bool(tokens))

    @api.post("", openapi_extra=body_of(SessionRequest), responses=refuses(400, 401, 403, 413, 422))
    async def post_session(request: Request, response: Response) -> SessionAnswer:
        """Begins a session for a page in a browser: sets a cookie."""
        wanted = await read_model(request, SessionRequest)
        role: Role | None = tokens.role_of(wanted.token) if tokens else "control"
        if role is None:
            raise HTTPException(401, "this token is not known: ask its operator for one")
        response.set_cookie(
            COOKIE, sessions.begin(role), max_age=SESSION_S, httponly=True, samesite="strict", secure=secure
        )
        return SessionAnswer(role=role, needs_token=bool(tokens))

    @api.delete("", responses=refuses(403))
    async def delete_session(request: Request, response: Response) -> SessionAnswer:
        """Ends it."""
        sessions.end(request.cookies.get(COOKIE, ""))
        response.delete_cookie(COOKIE, httponly=True, samesite="strict", secure=secure)
        return SessionAnswer(role=None, needs_token=bool(tokens))

    return api
