"""What is noted about every request: a line in the log, a measurement, and an id that joins them."""

import logging
import re
import time
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from grader.routes.uploads import UploadRoute
from grader.telemetry import context
from grader.telemetry.metrics import Metrics

HEADER = "X-Request-ID"
_WELL_FORMED = re.compile(r"[A-Za-z0-9._-]{8,64}")
_METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
_OFTEN_ASKED = frozenset({"/healthz", "/metrics", "/static"})  # by machines; they would fill the log
_NOWHERE = "none"
_log = logging.getLogger(__name__)


class Observed:
    """ASGI middleware around everything else.

    A request's id is the client's or a proxy's when it is well-formed, else a new one; the answer carries it.
    Only templates of routes and codes get into log and measurements, nothing of a request as it was sent.
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
        # never ended: the server gives each request a task, and what a failed one logs later is still about it
        context.begin(request_id=request_id)

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
                note()  # before the last of it is sent: who has an answer finds it measured
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        finally:
            note()


def _request_id(headers: Headers) -> str:
    given = headers.get(HEADER, "")
    return given if _WELL_FORMED.fullmatch(given) else uuid.uuid4().hex


def _note(scope: Scope, status: int, duration_s: float) -> None:
    method = scope["method"] if scope["method"] in _METHODS else "other"
    route = _template(scope)
    metrics: Metrics = scope["app"].state.services.metrics
    metrics.requested(method, route, status, duration_s)
    if isinstance(scope.get("route"), UploadRoute):
        metrics.uploaded(str(context.current().get("code", _NOWHERE)))
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
