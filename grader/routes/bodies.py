"""How much of a request's body is taken in. What is beyond is read for a while, dropped and refused.

Bodies are read before anybody is asked who they are: without a bound, anyone could fill the memory, and with
files in forms the disk.
"""

from collections.abc import Callable

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from grader.contracts.errors import RefusedError
from grader.contracts.text import Text

MOST_BYTES = 1024 * 1024
"""Of a body without files: the longest list of students a form takes is a third of it."""

_UNBOUNDED = "unbounded_receive"
_ENVELOPE_BYTES = 16 * 1024  # boundaries, part headers and the short fields beside a file
_DRAINED_BYTES = 8 * 1024 * 1024


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

        Raises:
            RefusedError: there are more than the limit, or the request says so.
        """
        message = await self._receive()
        self._left -= len(message.get("body", b""))
        if self._declared_too_large or self._left < 0:
            await self._drain(message)
            raise self._refuse()
        return message

    async def _drain(self, message: Message) -> None:
        """Read on for a while and drop it: most clients read no answer before they sent everything."""
        dropped = 0
        while message.get("more_body", False) and dropped < _DRAINED_BYTES:
            message = await self._receive()
            dropped += len(message.get("body", b""))


def with_file(request: Request, file_limit: int) -> Request:
    """Return a request for a form with one file of at most `file_limit` bytes, which may be more than others."""
    receive: Receive = request.scope["state"][_UNBOUNDED]
    limit = file_limit + _ENVELOPE_BYTES
    bounded = Bounded(receive, request.headers, limit, lambda: too_large(file_limit))
    return Request(request.scope, bounded.receive)


def media_type(headers: Headers) -> str:
    """Return the media type of a request's body, without its parameters."""
    return headers.get("content-type", "").partition(";")[0].strip().lower()


def too_large(limit: int) -> RefusedError:
    """Return the problem of a file beyond `limit` bytes."""
    kib = limit // 1024
    return RefusedError(
        "too_large",
        Text(zh=f"文件最大 {kib} KiB。", en=f"A file may have at most {kib} KiB."),
        field="file",
    )


def _too_long() -> RefusedError:
    kib = MOST_BYTES // 1024
    return RefusedError(
        "too_large", Text(zh=f"请求内容最大 {kib} KiB。", en=f"A request may have at most {kib} KiB.")
    )
