"""Pages of other sites are kept out: a browser would otherwise let them talk to a daemon on this machine."""

from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send


class SameOrigin:
    """Refuses what a browser sends for a page whose origin is not this server. Others send no Origin."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] in ("http", "websocket"):
            headers = Headers(scope=scope)
            origin = headers.get("origin")
            if origin is not None and urlsplit(origin).netloc != headers.get("host"):
                await self._refuse(origin, scope, receive, send)
                return
        await self._app(scope, receive, send)

    async def _refuse(self, origin: str, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
            return
        detail = f"a page of {origin} may not use this daemon: open the page from the daemon itself"
        await JSONResponse({"detail": detail}, 403)(scope, receive, send)
