"""`grader serve`: the HTTP service with its local workers."""

import argparse
import gc
import logging
import signal
import socket
import sys
from contextlib import nullcontext
from pathlib import Path
from types import FrameType

import uvicorn
from fastapi import FastAPI

from grader.commands.connections import HEADER_BYTES, BoundedConnection, most_connections
from grader.commands.options import add_language_option
from grader.contracts.errors import SettingsError
from grader.contracts.text import trouble

_log = logging.getLogger(__name__)
EXIT_COULD_NOT = 2
_BACKLOG = 512  # a class that hands in within the same second
_SWITCH_S = 0.0005
"""After this a thread that computes lets others go on. A request stops some thirty times, for the database and for
others, and while the dashboard was counted each stop took Python's usual 5 ms."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments; each overrides the setting of the same name (GRADER_HOST, ...)."""
    parser.add_argument("--host", help="address to listen on / 监听地址 (127.0.0.1)")
    parser.add_argument("--port", type=int, help="port; 0: a free one / 端口，0 表示任选 (8080)")
    parser.add_argument(
        "--data", type=Path, metavar="DIR", help="folder of the database (default: here) / 数据库所在文件夹"
    )
    parser.add_argument("--slots", type=int, help="gradings at once (one per core) / 同时评几份")
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop; running gradings finish first."""
    from grader.api import create_app
    from grader.commands.storage import database_url
    from grader.composition import running
    from grader.settings import load
    from grader.telemetry import logs

    settings = load(
        host=arguments.host,
        port=arguments.port,
        slots=arguments.slots,
        database_url=database_url(arguments.data),
    )
    logs.configure(settings.log_format, settings.log_level)
    sys.setswitchinterval(_SWITCH_S)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))  # starting may take as long as an upgrade
    with _listening(settings.host, settings.port) as listener, running(settings) as services:
        app = create_app(lambda: nullcontext(services))
        server = _Server(app, most_connections(settings.max_streams))
        # uvicorn raises the signal once more when it has stopped; to be told is no failure
        signal.signal(signal.SIGTERM, server.stop)
        if settings.log_format == "json":
            _log.info("listening on %s", _url(listener))
        else:
            sys.stderr.write(f"grader: {_url(listener)}/\n")
            sys.stderr.flush()
        server.run(sockets=[listener])
    return 0 if server.started else EXIT_COULD_NOT


class _Server(uvicorn.Server):
    """uvicorn, whose log lines are the service's, and whose connections are bounded."""

    def __init__(self, app: FastAPI, most_connections: int) -> None:
        config = uvicorn.Config(
            app,
            log_config=None,
            access_log=False,
            server_header=False,
            http=BoundedConnection,
            ws="none",
            limit_concurrency=most_connections,
            h11_max_incomplete_event_size=HEADER_BYTES,
        )
        super().__init__(config)

    def stop(self, number: int, frame: FrameType | None) -> None:
        """Stop as soon as possible; a signal handler."""
        self.should_exit = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Open everything, and take what lives as long as the service out of the garbage collector's sight.

        A full collection would otherwise look at every module's objects and stop all answers for a tenth of a
        second.
        """
        await super().startup(sockets)
        gc.collect()
        gc.freeze()


def _listening(host: str, port: int) -> socket.socket:
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
        told = trouble(error)
        raise SettingsError(
            f"cannot listen on {host}, port {port}: {told.en}; --port takes another one",
            f"无法监听 {host} 的 {port} 端口：{told.zh}；可以用 --port 换一个",
        ) from error


def _url(listener: socket.socket) -> str:
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"
