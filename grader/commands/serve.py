"""`grader serve`: the HTTP service with its local workers, and what one connection to it may take."""

import argparse
import asyncio
import gc
import logging
import resource
import signal
import socket
import sys
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any, Final

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from grader.commands.cli import EXIT_NOT_DONE
from grader.commands.options import add_language_option, whole_number
from grader.contracts.errors import SettingsError
from grader.contracts.text import trouble

if TYPE_CHECKING:
    from starlette.types import ASGIApp

    from grader.operation.settings import Settings
    from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_BACKLOG = 512  # a class that hands in within the same second
_SWITCH_S = 0.0005
"""How long a thread that computes keeps Python's interpreter lock. A request gives the lock up some thirty times;
while a dashboard was computed, getting it back took Python's usual 5 ms each time."""


HEADERS_S: Final = 15.0
BODY_S: Final = 60.0
"""A file of the usual limit arrives in time at 5 KB a second."""

ANSWER_S: Final = 180.0
"""The largest report is read in time at 5 KB a second."""

HEADER_BYTES: Final = 16 * 1024
_MOST_HEADER_BYTES = 16_384  # of a request, as h11 has it by itself
_PIECE_BYTES: Final = 4 * 1024
_CRUMBS: Final = 4
"""A chunked body is cut off when less than one part in `_CRUMBS` of what was sent is content. A chunk costs the
event loop as much as a small request: 30,000 of a byte each kept everybody waiting for seconds."""
_REQUESTS: Final = 1_500  # connections besides streams: browsers keep some open after each page
_OTHER_FILES: Final = 256  # the database, the log, gradings
_FEWEST: Final = 16  # fewer connections would not serve a class


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments; each overrides the setting of the same name (GRADER_HOST, ...)."""
    parser.add_argument("--host", help="address to listen on / 监听地址 (127.0.0.1)")
    parser.add_argument("--port", type=whole_number, help="port; 0: a free one / 端口，0 表示任选 (8080)")
    parser.add_argument(
        "--data", type=Path, metavar="DIR", help="folder of the database (default: here) / 数据库所在文件夹"
    )
    parser.add_argument("--slots", type=whole_number, help="gradings at once (one per core) / 同时评几份")
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop; running gradings finish first."""
    from grader.commands.storage import database_url
    from grader.live.cars import CLIENTS, websockets_installed
    from grader.operation import logs
    from grader.operation.settings import load

    settings = load(
        host=arguments.host,
        port=arguments.port,
        slots=arguments.slots,
        database_url=database_url(arguments.data),
    )
    logs.configure(settings.log_format, settings.log_level)
    sys.setswitchinterval(_SWITCH_S)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))  # starting may take as long as an upgrade
    live = settings.live_cars if websockets_installed() else 0
    most = most_connections(settings.max_streams + live * CLIENTS)
    with listening(settings.host, settings.port) as listener, _running(settings) as services:
        # takes a second, which nobody waits for whose settings are refused
        from grader.api import behind_proxies, create_app, warm_up

        app = create_app(lambda: nullcontext(services))
        warm_up(services)
        server = _Server(behind_proxies(app), most, websockets=live > 0)
        # uvicorn raises the signal once more after it has stopped; that must not look like a failure
        signal.signal(signal.SIGTERM, server.stop)
        if settings.log_format == "json":
            _log.info("listening on %s", _url(listener))
        else:
            sys.stderr.write(f"grader: {_url(listener)}/\n")
            sys.stderr.flush()
        server.run(sockets=[listener])
    return 0 if server.started else EXIT_NOT_DONE


def _running(settings: "Settings") -> AbstractContextManager["Services"]:
    """Return everything behind the application; imported only once the address is ours."""
    from grader.service.composition import running

    return running(settings)


class _Server(uvicorn.Server):
    """uvicorn, whose log lines are the service's, and whose connections are bounded."""

    def __init__(self, app: "ASGIApp", most_connections: int, *, websockets: bool = False) -> None:
        config = uvicorn.Config(
            app,
            proxy_headers=False,  # `behind_proxies` looks at them
            log_config=None,
            access_log=False,
            server_header=False,
            http=BoundedConnection,
            **_websockets(offered=websockets),
            limit_concurrency=most_connections,
            h11_max_incomplete_event_size=HEADER_BYTES,
        )
        super().__init__(config)

    def stop(self, number: int, frame: FrameType | None) -> None:
        """Stop as soon as possible; a signal handler."""
        self.should_exit = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Open everything, and take what lives as long as the service out of the garbage collector's sight.

        A full collection would otherwise look at every module's objects and stop all answers for a fifth of a
        second. None is made here either: of what was imported 1.5 MB are garbage, and stay.
        """
        await super().startup(sockets)
        gc.freeze()
        gc.enable()


def _websockets(*, offered: bool) -> dict[str, Any]:
    """Return uvicorn's arguments for websockets."""
    if not offered:
        return {"ws": "none"}
    from grader.live.protocol import SETTINGS, BoundedWebSocket

    return {"ws": BoundedWebSocket, **SETTINGS}


def listening(host: str, port: int) -> socket.socket:
    """Take the address before anything is opened, so that a second server fails at once and readably."""
    address = host.strip("[]")
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    try:
        listener = socket.create_server((address, port), family=family, backlog=_BACKLOG)
        # inherited by connections; asyncio sets it only on sockets whose protocol was named when created, and
        # without it every answer waits 40 ms for a delayed acknowledgement
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return listener
    except OSError as error:
        text = trouble(error)
        raise SettingsError(
            f"cannot listen on {host}, port {port}: {text.en}; --port takes another one",
            f"无法监听 {host} 的 {port} 端口：{text.zh}；可以用 --port 换一个",
        ) from error


def _url(listener: socket.socket) -> str:
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


# -------------------------------------------------------------------------------------------- connections


class _Http(h11.Connection):
    """HTTP as h11 reads it, but for a request whose end can be read in two ways (RFC 9112, 6.3: 400).

    A proxy that goes by the other way would take the rest of its body for another request, or the reverse.
    """

    def next_event(self) -> h11.Event | type[h11.NEED_DATA] | type[h11.PAUSED]:
        """Return what comes next.

        Raises RemoteProtocolError: it is no HTTP, or has Content-Length and Transfer-Encoding.
        """
        event = super().next_event()
        if isinstance(event, h11.Request):
            names = {name for name, _ in event.headers}
            if {b"content-length", b"transfer-encoding"} <= names:
                raise h11.RemoteProtocolError("Content-Length and Transfer-Encoding")
        return event


class BoundedConnection(H11Protocol):
    """uvicorn's connection; it ends when a request takes too long to arrive or its answer too long to be read.

    It also ends when there are too many.

    uvicorn itself waits for ever for a request that never ends: a client that opens connections and sends a byte
    now and then would take every file descriptor of the process, and the gradings with them. A proxy in front does
    this earlier and better; this is for those without one.
    """

    headers_s = HEADERS_S
    body_s = BODY_S
    answer_s = ANSWER_S

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request."""
        self.conn = _Http(h11.SERVER, self.config.h11_max_incomplete_event_size or _MOST_HEADER_BYTES)
        super().connection_made(transport)
        self._awaited: str | None = None
        self._upgraded = False
        # Bytes of the request's body as they were sent, and without what frames chunks.
        self._chunked = (
            0,
            0,
        )
        self._deadline: asyncio.TimerHandle | None = None
        self._unread: asyncio.TimerHandle | None = None
        if self.limit_concurrency is not None and len(self.connections) > self.limit_concurrency:
            transport.abort()
            return
        self._await("headers")

    def data_received(self, data: bytes) -> None:
        """Take what arrived of a request, a piece at a time."""
        for start in range(0, len(data), _PIECE_BYTES):
            if self._upgraded:
                self.transport.get_protocol().data_received(data[start:])  # type: ignore[attr-defined]
                return
            piece, in_body, before = data[start : start + _PIECE_BYTES], self._in_body(), self._body_bytes()
            super().data_received(piece)
            sent, body = self._chunked if in_body else (0, 0)
            sent, body = self._chunked = sent + len(piece), body + max(self._body_bytes() - before, 0)
            if in_body and sent >= _PIECE_BYTES and body * _CRUMBS < sent and self._is_chunked():
                self.transport.abort()
            if self.transport.is_closing():
                return
        if not self._upgraded:
            self._look()

    def on_response_complete(self) -> None:
        """Wait for the next request; until its first byte uvicorn's own keep-alive limit applies."""
        super().on_response_complete()
        self._look()

    def pause_writing(self) -> None:
        """Wait for the client to read what was sent."""
        super().pause_writing()
        if self._unread is None:
            self._unread = self.loop.call_later(self.answer_s, self.transport.abort)

    def resume_writing(self) -> None:
        """Go on to send."""
        super().resume_writing()
        self._read()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Hand the connection over to a websocket, which has bounds of its own."""
        self._await(None)
        self._read()
        self._upgraded = True
        super().handle_websocket_upgrade(event)

    def shutdown(self) -> None:
        """Stop without waiting for requests that have not arrived completely: the time belongs to the gradings."""
        if self._awaited is None:
            super().shutdown()
        else:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._await(None)
        self._read()
        super().connection_lost(exc)

    def _in_body(self) -> bool:
        return self.conn.their_state is h11.SEND_BODY

    def _body_bytes(self) -> int:
        return 0 if self.cycle is None else len(self.cycle.body)

    def _is_chunked(self) -> bool:
        return any(name == b"transfer-encoding" for name, _ in self.headers)

    def _read(self) -> None:
        if self._unread is not None:
            self._unread.cancel()
            self._unread = None

    def _look(self) -> None:
        """See what the client still has to send."""
        state = self.conn.their_state
        begun = state is h11.IDLE and bool(self.conn.trailing_data[0])
        self._await("body" if self._in_body() else "headers" if begun else None)

    def _await(self, what: str | None) -> None:
        if what == self._awaited:
            return
        if self._deadline is not None:
            self._deadline.cancel()
        self._awaited = what
        limit_s = self.body_s if what == "body" else self.headers_s
        self._deadline = None if what is None else self.loop.call_later(limit_s, self._end)

    def _end(self) -> None:
        _log.debug("a request's %s did not arrive in time", self._awaited)
        self.transport.abort()


def most_connections(streams: int) -> int:
    """Return how many connections at once, with so many `streams` of events, leave room for other files.

    Raises the process's limit of open files as far as the system allows: the usual one is too low for a class.

    Raises SettingsError: the system lets this process open too few.
    """
    wanted = streams + _REQUESTS
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < wanted + _OTHER_FILES:
        soft = wanted + _OTHER_FILES if hard == resource.RLIM_INFINITY else min(hard, wanted + _OTHER_FILES)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    if soft == resource.RLIM_INFINITY:
        return wanted
    if soft - _OTHER_FILES < _FEWEST:
        needed = _OTHER_FILES + _FEWEST
        raise SettingsError(
            f"this process may open {soft} files only: let it open {needed} or more (ulimit -n)",
            f"这个进程只能打开 {soft} 个文件：请放宽到 {needed} 个以上（ulimit -n）",
        )
    return min(wanted, soft - _OTHER_FILES)
