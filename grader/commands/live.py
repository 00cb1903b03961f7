"""`grader live`: a turtle of one's own in real time, behind rosbridge, on this machine and without a course."""

import argparse
import asyncio
import sys
from collections.abc import MutableMapping
from contextlib import suppress
from typing import Any, Final
from urllib.parse import urlsplit

from grader.commands.cli import EXIT_NOT_DONE
from grader.commands.options import add_language_option, whole_number
from grader.contracts.extras import MissingExtraError

_CLIENTS: Final = 64
_CONNECTIONS: Final = 128
_PORT: Final = 9090
_PLAIN: Final = b"This is rosbridge: connect by websocket (ws://).\n"
_LOOPBACK: Final = ("127.0.0.1", "::1", "localhost")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("--host", choices=_LOOPBACK, default="127.0.0.1",
                        help="address of this machine to listen on / 监听的本机地址 (127.0.0.1)")  # fmt: skip
    parser.add_argument(
        "--port", type=whole_number, default=_PORT, help="port; 0: a free one / 端口，0 表示任选 (9090)"
    )
    parser.add_argument("--allow-origin", action="append", default=[], metavar="ORIGIN",
                        help="let web pages of this origin in, such as null for files; pages of this machine "
                        "are let in anyway / 允许这个来源的网页连接；本机网页总是允许")  # fmt: skip
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl+C."""
    try:
        import uvicorn

        from grader.live.protocol import SETTINGS, BoundedWebSocket
    except ModuleNotFoundError as error:
        raise MissingExtraError.named("live") from error
    from grader.commands.serve import BoundedConnection, listening

    app = _App(frozenset(arguments.allow_origin), arguments.lang)
    with listening(arguments.host, arguments.port) as listener:
        app.port = listener.getsockname()[1]
        config = uvicorn.Config(
            app,
            log_config=None,
            access_log=False,
            server_header=False,
            http=BoundedConnection,
            ws=BoundedWebSocket,
            limit_concurrency=_CONNECTIONS,
            lifespan="on",
            **SETTINGS,
        )
        server = uvicorn.Server(config)
        with suppress(KeyboardInterrupt):  # how it ends; uvicorn raises it once more, or not, as it comes
            server.run(sockets=[listener])
    return 0 if server.started else EXIT_NOT_DONE


class _App:
    """One car for all who come."""

    def __init__(self, origins: frozenset[str], language: str) -> None:
        from grader.live.car import LiveCar

        self.port = _PORT
        self._origins = origins
        self._language = language
        self._car = LiveCar(_CLIENTS)
        self._starting = asyncio.Lock()

    async def __call__(self, scope: MutableMapping[str, Any], receive: Any, send: Any) -> None:
        """Serve one websocket; answer any other request with what this server is."""
        from grader.live.connection import is_own_origin, refuse, serve

        if scope["type"] == "lifespan":
            await self._live(receive, send)
        elif scope["type"] == "http":
            length = str(len(_PLAIN)).encode()
            headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", length)]
            await send({"type": "http.response.start", "status": 426, "headers": headers})
            await send({"type": "http.response.body", "body": _PLAIN})
        elif not is_own_origin(scope, self._is_allowed):
            await refuse(send, 403, "foreign_form")
        else:
            async with self._starting:
                # Its process has died: nobody needs to start the command again for that.
                if not self._car.alive:
                    await self._car.start()
            await serve(receive, send, self._car)

    async def _live(self, receive: Any, send: Any) -> None:
        await receive()
        await self._car.start()
        sys.stderr.write(f"grader: ws://127.0.0.1:{self.port}\n")
        sys.stderr.flush()
        await send({"type": "lifespan.startup.complete"})
        await receive()
        self._car.end()
        await send({"type": "lifespan.shutdown.complete"})

    def _is_allowed(self, origin: str) -> bool:
        return origin in self._origins or urlsplit(origin).hostname in _LOOPBACK
