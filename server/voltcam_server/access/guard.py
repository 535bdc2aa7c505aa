"""Before any request: is it for this host, from our own page, and from someone who may?

A browser lets any page talk to a daemon on its own machine, and a name that is made to point to 127.0.0.1
makes it the page's own origin. So the name of the host is held against a list, and the origin against it.
"""

import ipaddress
from collections.abc import Iterable
from http.cookies import CookieError, SimpleCookie
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .session import COOKIE, Sessions
from .tokens import Role, Tokens

OPEN_PATHS = ("/healthz", "/readyz", "/api/v1/session")
GUARDED = ("/api/", "/metrics")
READING = ("GET", "HEAD", "OPTIONS")
POLICY_VIOLATION = 1008  # WebSocket close code

COMMON_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}
PAGE_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'none'"
)
REPORT_POLICY = (  # a page of its own, its figures and styles in it, without a script
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
REPORT = "/api/v1/diagnosis/report"


class Guard:
    """Refuses what is not for this daemon, or from someone who may not; puts policies on what it answers."""

    def __init__(self, app: ASGIApp, hosts: Iterable[str], tokens: Tokens, sessions: Sessions) -> None:
        self._app, self._tokens, self._sessions = app, tokens, sessions
        self._hosts = {"localhost", *(host.lower().rstrip(".") for host in hosts)}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        role = self._role(headers)
        scope["voltcam_role"] = role
        code, detail = self._refusal(scope, headers, role)
        if code and scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": detail[:120]})
        elif code:
            challenge = {"WWW-Authenticate": "Bearer"} if code == 401 else None
            answer = JSONResponse({"detail": detail}, code, challenge)
            await answer(scope, receive, _with_policies(scope, send))
        else:
            await self._app(scope, receive, _with_policies(scope, send))

    def _refusal(self, scope: Scope, headers: Headers, role: Role | None) -> tuple[int, str]:
        """HTTP status and reason; 0 where there is none."""
        host = headers.get("host", "")
        if not self._known(host):
            return (
                403,
                f"the host {host[:80]!r} is not this daemon's: its operator can add it to access.hosts",
            )
        origin = headers.get("origin")
        if origin is not None and _netloc(origin) != host:
            return (
                403,
                f"a page of {origin[:80]} may not use this daemon: open the page from the daemon itself",
            )
        path: str = scope["path"]
        if path in OPEN_PATHS or not path.startswith(GUARDED):
            return 0, ""
        if role is None:
            return (
                401,
                "this needs a token: send `Authorization: Bearer TOKEN`, or begin a session on the page",
            )
        if role != "control" and scope["type"] == "http" and scope["method"] not in READING:
            return 403, "this token may look, not change: ask the operator for one with the role `control`"
        return 0, ""

    def _known(self, host: str) -> bool:
        try:
            name = (urlsplit(f"//{host}").hostname or "").rstrip(".")
        except ValueError:
            return False
        return name in self._hosts or _is_address(name)

    def _role(self, headers: Headers) -> Role | None:
        if not self._tokens:
            return "control"
        scheme, _, token = headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer" and token:
            return self._tokens.role_of(token.strip())
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
        except CookieError:
            return None
        return self._sessions.role_of(cookie.value) if cookie else None


def _is_address(name: str) -> bool:
    """An address of numbers: no name server can point it elsewhere."""
    try:
        ipaddress.ip_address(name.partition("%")[0])
    except ValueError:
        return False
    return True


def _netloc(origin: str) -> str | None:
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return None


def _with_policies(scope: Scope, send: Send) -> Send:
    policy = REPORT_POLICY if scope["path"] == REPORT else PAGE_POLICY

    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers["Content-Security-Policy"] = policy
            for name, value in COMMON_HEADERS.items():
                headers[name] = value
        await send(message)

    return sending
