"""Web application of a live walk: the page, its WebSocket, the address that apps push to, and the report at the end.

Every address begins with a secret part; without it there is nothing to see. Files of the disk are served only by
name from the folder of the finished report.
"""

import asyncio
import json
import secrets
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from pdr_est.errors import OutputError, PdrError
from pdr_est.live.poses import MODES
from pdr_est.live.receivers.pushed import PushedMessages
from pdr_est.live.session import LiveSession
from pdr_est.live.visitor import Visitor
from pdr_est.report.live_page import render_live_page

STATUS_EVERY_S = 1.0
"""Pause between two messages with the state of the phones, s."""

_HEADERS = {
    "cache-control": "no-store",
    "referrer-policy": "no-referrer",  # an address holds its token
    "x-content-type-options": "nosniff",
    "cross-origin-resource-policy": "same-origin",
}
_TYPES = {".html": "text/html", ".json": "application/json", ".geojson": "application/geo+json", ".csv": "text/csv"}
_POLICY_VIOLATION, _TRY_AGAIN = 1008, 1013


class LiveApp:
    """The web application of one walk.

    Parameters
    ----------
    session
        The walk.
    pushed
        Reader of pushed messages; None if no app may push, as during a replay.
    page_token, push_token
        Secret parts of the address of the page, and of the address that apps push to.
    """

    def __init__(self, session: LiveSession, pushed: PushedMessages | None, page_token: str, push_token: str) -> None:
        self._session, self._pushed = session, pushed
        self._page_token, self._push_token = page_token, push_token
        self._phones: dict[str, Any] = {}
        self._live_page = render_live_page(MODES, session.plan)
        self._open_pages = 0
        self.report_folder: Path | None = None
        self.report_files: Collection[str] = ()

    @property
    def may_push(self) -> bool:
        """Tell whether apps may push samples."""
        return self._pushed is not None

    def pages(self) -> ASGIApp:
        """Return the application with everything."""
        return self._application(
            Route("/{token}/", self._page),
            Route("/{token}/report/{name}", self._report),
            Route("/{token}/push", self._push, methods=["POST"]),
            WebSocketRoute("/{token}/link", self._link),
        )

    def push_only(self) -> ASGIApp:
        """Return the application for the port without encryption, which only takes what apps push."""
        return self._application(Route("/{token}/push", self._push, methods=["POST"]))

    def knows(self, path: str) -> bool:
        """Tell whether a path begins with the secret part of one of the addresses."""
        named = path.removeprefix("/").partition("/")[0].encode()
        of_page = secrets.compare_digest(named, self._page_token.encode())
        return secrets.compare_digest(named, self._push_token.encode()) or of_page

    def publish_report(self, folder: Path, names: Collection[str]) -> None:
        """Serve these files of a folder from now on."""
        self.report_folder, self.report_files = folder, frozenset(names)

    def _application(self, *routes: Route | WebSocketRoute) -> ASGIApp:
        application = Starlette(routes=list(routes), exception_handlers={404: _nothing, 405: _nothing})
        application.router.redirect_slashes = False
        return _with_headers(application)

    def _allowed(self, request: Request | WebSocket, token: str) -> bool:
        return secrets.compare_digest(str(request.path_params["token"]).encode(), token.encode())

    async def _page(self, request: Request) -> Response:
        if not self._allowed(request, self._page_token):
            return await _nothing(request, None)
        page, policy = self._live_page
        return HTMLResponse(page, headers={"content-security-policy": policy})

    async def _report(self, request: Request) -> Response:
        name = request.path_params["name"]
        folder = self.report_folder
        if not self._allowed(request, self._page_token) or folder is None or name not in self.report_files:
            return await _nothing(request, None)
        content = await run_in_threadpool((folder / name).read_bytes)
        kind = _TYPES.get(Path(name).suffix, "application/octet-stream")
        return Response(content, media_type=kind, headers={"content-security-policy": "frame-ancestors 'self'"})

    async def _push(self, request: Request) -> Response:
        """Take a message of Sensor Logger; the app shows the text of an answer that is not 200."""
        if not self._allowed(request, self._push_token) or self._pushed is None:
            return await _nothing(request, None)
        most = self._session.limits.push_bytes
        content = bytearray()
        async for piece in request.stream():
            content += piece
            if len(content) > most:
                return PlainTextResponse(f"more than {most >> 20} MiB in one message", 413)
        try:
            await run_in_threadpool(self._pushed.take, content.decode("utf-8", "replace"))
        except PdrError as error:
            self._session.tell(str(error))
            return PlainTextResponse(str(error), 507 if isinstance(error, OutputError) else 400)
        return PlainTextResponse("ok")

    async def _link(self, socket: WebSocket) -> None:
        """Talk to a page: poses and status go out; motion events, positions and the end of the walk come in."""
        if not self._allowed(socket, self._page_token) or not _same_origin(socket):
            await socket.close(_POLICY_VIOLATION)
            return
        await socket.accept()
        if self._open_pages >= self._session.limits.pages:
            await _closed(socket, _TRY_AGAIN, "too many pages are open")
            return
        self._open_pages += 1
        visitor = Visitor(self._session, self._phones)
        sending = asyncio.create_task(self._send(socket, visitor))
        try:
            while True:
                answer = visitor.take(_object(await socket.receive_text()))
                if answer is not None:
                    visitor.post(answer)
        except PdrError as error:
            self._session.tell(str(error))
            await _closed(socket, _POLICY_VIOLATION, str(error))
        except (WebSocketDisconnect, RuntimeError, KeyError):  # gone, closed here meanwhile, or not a text
            pass
        finally:
            self._open_pages -= 1
            visitor.leave()
            sending.cancel()

    async def _send(self, socket: WebSocket, visitor: Visitor) -> None:
        for message in visitor.enter(asyncio.get_running_loop()):
            await socket.send_text(json.dumps(message))
        reporting = asyncio.create_task(_again_and_again(lambda: visitor.post(self._session.status())))
        try:
            while (news := await visitor.next_message()) is not None:
                await socket.send_text(json.dumps(news))
            await _closed(socket, _TRY_AGAIN, "this page was too slow: it loads everything again")
        except (WebSocketDisconnect, RuntimeError):
            pass
        finally:
            reporting.cancel()


async def _again_and_again(work: Callable[[], None]) -> None:
    while True:
        await asyncio.sleep(STATUS_EVERY_S)
        work()


async def _closed(socket: WebSocket, code: int, reason: str) -> None:
    try:
        await socket.close(code, reason[:100])
    except RuntimeError:  # the other side was faster
        return


async def _nothing(_request: Request, _error: Exception | None) -> Response:
    return PlainTextResponse("nothing here", 404)


def _object(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _same_origin(socket: WebSocket) -> bool:
    """Tell whether a page of this server opens the connection; programs that are no browsers state no origin."""
    origin = socket.headers.get("origin")
    return origin is None or origin.partition("//")[2] == socket.headers.get("host")


def _with_headers(application: ASGIApp) -> ASGIApp:
    """Add the headers that every answer has."""
    added = [(name.encode(), value.encode()) for name, value in _HEADERS.items()]

    async def wrapped(scope: Scope, receive: Receive, send: Send) -> None:
        async def send_with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", ()), *added]
            await send(message)

        await application(scope, receive, send_with_headers if scope["type"] == "http" else send)

    return wrapped
