"""What happens around every request: a bound on its body, the headers of its answer, a line in the log.

Bodies are read before anybody is asked who they are: without a bound, anyone could fill the memory, and with files
in forms the disk. Of a body beyond the bound some more is read and dropped, then the request is refused.
"""

import logging
import os
import re
import time
import uuid
from collections.abc import Callable, Coroutine
from datetime import datetime
from http import HTTPStatus
from typing import Any
from urllib.parse import urlsplit, urlunsplit

from fastapi import Request, Response
from fastapi.routing import APIRoute
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from grader.contracts.errors import RefusedError
from grader.operation import logs
from grader.operation.metrics import Metrics
from grader.service.requests.dependencies import (
    PEER,
    is_held,
    parameters,
    refuse,
    sent_twice,
    unknown,
)
from grader.use_cases.handing_in import most_upload_bytes, too_large

MOST_BYTES = 1024 * 1024
"""Of a body without files: the longest list of students a form takes is a third of it."""

HEADER = "X-Request-ID"
_UNBOUNDED = "unbounded_receive"
_ENVELOPE_BYTES = 16 * 1024  # boundaries, part headers and the short fields beside a file
_MOST_FILES, _MOST_FIELDS = 2, 20  # of a form with a file
_DRAINED_BYTES = 8 * 1024 * 1024
_SMALL_BYTES = 64 * 1024  # uvicorn keeps as much for a client that does not read, before it waits
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "private, no-cache",
}
_OF_STREAMS = "no-cache"  # FastAPI's; a cache that many share might keep the stream
_SLASH_REDIRECT = 307
_OF_A_BODY = ("Content-Length", "Content-Type", "Content-Encoding", "Content-Disposition")
_WELL_FORMED = re.compile(r"[A-Za-z0-9._-]{8,64}")
_METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
_OFTEN_ASKED = frozenset({"/healthz", "/metrics", "/static"})  # by machines; they would fill the log
_NOWHERE = "none"
_THIS_MACHINE = "127.0.0.1,::1"
_log = logging.getLogger(__name__)


class SafeHeaders:
    """ASGI middleware that adds headers to each answer which has not set its own.

    An answer that does not say how long it holds is asked for again each time. Almost all of it is somebody's, and
    from the age of a file browsers would guess that a script is good for months, also after an upgrade.

    An address with a slash too many leads to the one without. Starlette names the host that the request has named,
    which may be anybody's, and a scheme that is not the one outside unless a proxy tells. Both are left out.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
                if headers["Cache-Control"] == _OF_STREAMS:
                    headers["Cache-Control"] = _HEADERS["Cache-Control"]
                if message["status"] == _SLASH_REDIRECT:
                    headers["Location"] = _on_this_host(headers["Location"])
            await send(message)

        await self._app(scope, receive, send_with_headers if scope["type"] == "http" else send)


class KnownPeer:
    """ASGI middleware that notes who holds the connection, before it believes whose request a proxy passes on.

    It does for `X-Forwarded-For` and `X-Forwarded-Proto` what uvicorn does, from the addresses in
    ``FORWARDED_ALLOW_IPS`` (this machine without it), and must be the outermost.
    """

    def __init__(self, app: ASGIApp) -> None:
        trusted = os.environ.get("FORWARDED_ALLOW_IPS", _THIS_MACHINE)
        # uvicorn's types of ASGI are its own
        self._app: Any = ProxyHeadersMiddleware(app, trusted_hosts=trusted)  # type: ignore[arg-type]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] == "http":
            scope = {**scope, PEER: scope["client"]}
        await self._app(scope, receive, send)


class HeldToTheEnd:
    """ASGI middleware that ends a large answer only when almost all of it has been read.

    uvicorn takes any amount in one part and returns at once. Whoever asked and does not read would then no longer
    count as having a request under way, and could have as many answers kept in memory as there may be connections.
    Before it takes the next part, uvicorn waits until the client has read most of those before.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""

        async def send_in_two(message: Message) -> None:
            is_last = message["type"] == "http.response.body" and not message.get("more_body", False)
            if not is_last or len(message.get("body", b"")) <= _SMALL_BYTES:
                await send(message)
                return
            await send({**message, "more_body": True})
            await send({"type": "http.response.body", "body": b"", "more_body": False})

        await self._app(scope, receive, send_in_two if scope["type"] == "http" else send)


class Unchanged:
    """ASGI middleware that answers 304 where the client has what it asks for (RFC 9110, section 13.1.2).

    The dashboard looks by itself, because its tag is known before its content is made. What nobody may keep is
    always sent: its tag is that of what may be changed, and more stands beside it.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        is_read = scope["type"] == "http" and scope["method"] == "GET"
        held = Headers(scope=scope).get("if-none-match") if is_read else None
        leaves_out = False

        async def send_unless_held(message: Message) -> None:
            nonlocal leaves_out
            if message["type"] == "http.response.start" and message["status"] == HTTPStatus.OK:
                headers = MutableHeaders(scope=message)
                leaves_out = not _is_kept_by_nobody(headers) and is_held(held or "", headers.get("etag", ""))
                if leaves_out:
                    message["status"] = HTTPStatus.NOT_MODIFIED.value
                    for name in _OF_A_BODY:
                        del headers[name]
            elif leaves_out:
                message = {**message, "body": b""}
            await send(message)

        await self._app(scope, receive, send if held is None else send_unless_held)


class HeadAsGet:
    """ASGI middleware that has HEAD answered as GET; the server leaves the body out (RFC 9110, section 9.3.2).

    It must be around everything else: what is told of the request by the router is written into the scope.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        is_head = scope["type"] == "http" and scope["method"] == "HEAD"
        await self._app({**scope, "method": "GET"} if is_head else scope, receive, send)


class BoundedBodies:
    """ASGI middleware that bounds every body, wherever it is sent, unless the route takes files."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        scope.setdefault("state", {})[_UNBOUNDED] = receive
        await self._app(scope, Bounded(receive, Headers(scope=scope), MOST_BYTES, _too_long).receive, send)


class Bounded:
    """Passes a request's body on up to a limit.

    Args:
        receive: the request's. headers: the request's.
        limit: most bytes. refuse: returns what is raised when there are more.
    """

    def __init__(
        self, receive: Receive, headers: Headers, limit: int, refuse: Callable[[], RefusedError]
    ) -> None:
        self._receive = receive
        self._left = limit
        self._refuse = refuse
        declared = headers.get("content-length", "")
        self._declared_too_large = declared.isdecimal() and int(declared) > limit

    async def receive(self) -> Message:
        """Return the next part of the body.

        Raises RefusedError: there are more than the limit, or the request says so.
        """
        message = await self._receive()
        self._left -= len(message.get("body", b""))
        if self._declared_too_large or self._left < 0:
            await self._drain(message)
            raise self._refuse()
        return message

    async def _drain(self, message: Message) -> None:
        """Read some more and drop it: most clients read no answer before they have sent everything."""
        dropped = 0
        while message.get("more_body", False) and dropped < _DRAINED_BYTES:
            message = await self._receive()
            dropped += len(message.get("body", b""))


class _SmallForm(Request):
    """A request whose form has few parts: parsing each of a thousand would keep the event loop busy."""

    def form(self, **_: Any) -> Any:
        """Return the form, as Starlette does for any request."""
        return super().form(max_files=_MOST_FILES, max_fields=_MOST_FIELDS)


def with_file(request: Request, file_limit: int) -> Request:
    """Return a request for a form with one file of at most `file_limit` bytes, which may be more than others."""
    receive: Receive = request.scope["state"][_UNBOUNDED]
    limit = file_limit + _ENVELOPE_BYTES
    bounded = Bounded(receive, request.headers, limit, lambda: too_large(file_limit))
    return _SmallForm(request.scope, bounded.receive)


def media_type(headers: Headers) -> str:
    """Return the media type of a request's body, without its parameters."""
    return headers.get("content-type", "").partition(";")[0].strip().lower()


class UploadRoute(APIRoute):
    """A route for one uploaded file: its body is checked by type before it is read, and by size meanwhile.

    The form's parser alone would write any amount to disk before the endpoint sees the first byte.
    """

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Put the two checks before FastAPI's own handler."""
        handle = super().get_route_handler()

        async def bounded(request: Request) -> Response:
            if media_type(request.headers) != "multipart/form-data":
                raise RefusedError("unsupported_media_type")
            request.state.arrived_at = request.app.state.services.clock()
            limit = most_upload_bytes(request.app.state.services)
            return await handle(with_file(request, limit))

        return bounded


def arrival_of(request: Request) -> datetime:
    """Return the instant at which a request to an `UploadRoute` came in, before its body was read.

    Dates and limits go by it, so that a busy service makes nobody late.
    """
    instant: datetime = request.state.arrived_at
    return instant


async def known_parts(request: Request) -> None:
    """Refuse a form with a part that is not read: the second of a name, or one whose name is misspelt.

    Raises RequestValidationError: there is one.
    """
    form = await request.form()
    names = parameters(request.scope["route"].dependant, "body_params")
    problems = sent_twice(form)
    if misspelt := unknown(form, names):
        problems += misspelt
        problems += [
            ("missing", name) for name, is_required in names.items() if is_required and name not in form
        ]
    refuse("body", problems)


def _too_long() -> RefusedError:
    kib = MOST_BYTES // 1024
    return RefusedError.saying(
        "too_large", zh=f"请求内容最大 {kib} KiB。", en=f"A request may have at most {kib} KiB."
    )


class Observed:
    """ASGI middleware around everything else: gives each request an id, measures and logs it.

    The id is the one that the client or a proxy sent, if it is well-formed, else a new one; the answer carries it.
    Log and measurements get route templates and codes only, never text that a client sent.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun_s, status, noted = time.monotonic(), 500, False
        request_id = _request_id(Headers(scope=scope))
        scope.setdefault("state", {})["request_id"] = request_id
        # not ended here: each request has its own task, and what the server logs after a failure is about it, too
        logs.begin(request_id=request_id)

        def note() -> None:
            nonlocal noted
            if not noted:
                noted = True
                _note(scope, status, time.monotonic() - begun_s)

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[HEADER] = request_id
            elif not message.get("more_body", False):
                note()  # before the last part is sent, so that a client with an answer finds it counted
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        finally:
            note()


def _is_kept_by_nobody(headers: Headers) -> bool:
    return "no-store" in headers.get("cache-control", "")


def _on_this_host(address: str) -> str:
    parts = urlsplit(address)
    return urlunsplit(("", "", "/" + parts.path.lstrip("/"), parts.query, ""))


def _request_id(headers: Headers) -> str:
    request_id = headers.get(HEADER, "")
    return request_id if _WELL_FORMED.fullmatch(request_id) else uuid.uuid4().hex


def _note(scope: Scope, status: int, duration_s: float) -> None:
    method = scope["method"] if scope["method"] in _METHODS else "other"
    route = _template(scope)
    metrics: Metrics = scope["app"].state.services.metrics
    metrics.requested(method, route, status, duration_s)
    if isinstance(scope.get("route"), UploadRoute):
        metrics.uploaded(str(logs.current().get("code", _NOWHERE)))
    level = logging.DEBUG if route in _OFTEN_ASKED else logging.INFO
    fields = {"method": method, "route": route, "status": status, "duration_ms": round(duration_s * 1000, 1)}
    _log.log(level, "answered", extra=fields)


def _template(scope: Scope) -> str:
    """Return the template of the route that answered; a mount's prefix; or that there was none."""
    if (route := scope.get("route")) is not None:
        return str(route.path)
    if "endpoint" not in scope:
        return _NOWHERE
    return str(scope["root_path"] if "app_root_path" in scope else scope["path"])
