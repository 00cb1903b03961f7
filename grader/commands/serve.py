"""`grader serve`: the HTTP service with its local workers."""

import argparse
import socket
import sys
from pathlib import Path
from typing import Any

from grader.contracts.errors import SettingsError

EXIT_COULD_NOT = 2
_BACKLOG = 512  # a class that hands in within the same second


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments; each overrides the setting of the same name (GRADER_HOST, ...)."""
    parser.add_argument("--host", help="address to listen on (default: 127.0.0.1)")
    parser.add_argument("--port", type=int, help="port; 0 takes a free one (default: 8080)")
    parser.add_argument("--data", type=Path, metavar="DIR", help="folder of the database (default: here)")
    parser.add_argument("--slots", type=int, help="gradings at once (default: one per core)")


def run(arguments: argparse.Namespace) -> int:
    """Serve until told to stop; running gradings finish first."""
    import uvicorn

    from grader.api import create_app
    from grader.service import require_safe_exposure, running
    from grader.settings import load

    settings = load(**_overrides(arguments))
    require_safe_exposure(settings)
    app = create_app(lambda: running(settings))
    with _listening(settings.host, settings.port) as listener:
        sys.stderr.write(f"grader: {_url(listener)}/\n")
        sys.stderr.flush()
        server = uvicorn.Server(uvicorn.Config(app, log_level="warning", server_header=False))
        server.run(sockets=[listener])
    return 0 if server.started else EXIT_COULD_NOT


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
        raise SettingsError(f"cannot listen on {host}, port {port}: {error.strerror or error}") from error


def _url(listener: socket.socket) -> str:
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _overrides(arguments: argparse.Namespace) -> dict[str, Any]:
    given: dict[str, Any] = {
        name: getattr(arguments, name)
        for name in ("host", "port", "slots")
        if getattr(arguments, name) is not None
    }
    if arguments.data is not None:
        from grader.commands.storage import database_url

        given["database_url"] = database_url(arguments.data)
    return given
