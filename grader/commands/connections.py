"""What one connection to `grader serve` may take: uvicorn itself waits for ever for a request that never ends.

Whoever opens connections and sends a byte now and then would otherwise take every file descriptor of the process,
and with them the gradings. A proxy in front does the same earlier and better; here it is for those without one.
"""

import asyncio
import logging
import resource
from typing import Final

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from grader.contracts.errors import SettingsError

HEADERS_S: Final = 15.0
BODY_S: Final = 60.0
"""A file of the usual limit arrives in time at 5 KB a second."""

HEADER_BYTES: Final = 16 * 1024
_REQUESTS: Final = 1_500  # connections besides streams: browsers keep some open after each page
_OTHER_FILES: Final = 256  # the database, the log, gradings
_FEWEST: Final = 16  # connections without which nobody would call it a service
_log = logging.getLogger(__name__)


class BoundedConnection(H11Protocol):
    """uvicorn's connection; it ends when a request takes too long to arrive, or when there are too many."""

    headers_s = HEADERS_S
    body_s = BODY_S

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request."""
        super().connection_made(transport)
        self._awaited: str | None = None
        self._deadline: asyncio.TimerHandle | None = None
        if self.limit_concurrency is not None and len(self.connections) > self.limit_concurrency:
            transport.abort()
            return
        self._await("headers")

    def data_received(self, data: bytes) -> None:
        """Take what arrived of a request."""
        super().data_received(data)
        self._look()

    def on_response_complete(self) -> None:
        """Go on to the next request, for whose first byte uvicorn waits as long as it keeps connections alive."""
        super().on_response_complete()
        self._look()

    def shutdown(self) -> None:
        """Stop: what did not arrive in whole is not waited for, so that a stop has its time for the gradings."""
        if self._awaited is None:
            super().shutdown()
        else:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._await(None)
        super().connection_lost(exc)

    def _look(self) -> None:
        """See what the client still owes."""
        state = self.conn.their_state
        begun = state is h11.IDLE and bool(self.conn.trailing_data[0])
        self._await("body" if state is h11.SEND_BODY else "headers" if begun else None)

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
    """Return how many connections at once leave room for everything else that needs files.

    The process may open as many files as the system lets it: few systems' usual limit suffices for a class.

    Args:
        streams: most streams of events.

    Raises:
        SettingsError: the system lets this process open too few.
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
