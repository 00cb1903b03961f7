"""uvicorn's websocket, bounded: the server stops reading from a client that does not read."""

import asyncio
import logging
from typing import Any, Final, TypedDict

from uvicorn.protocols.websockets.wsproto_impl import WSProtocol

from grader.sim.rosbridge.frames import MAX_FRAME_BYTES

UNREAD_S: Final = 10.0  # how long a client may leave what it was sent unread
_logger: Final = logging.getLogger(__name__)
_logger.setLevel(logging.WARNING)


class WebSocketSettings(TypedDict):
    """Arguments of `uvicorn.Config`."""

    ws_max_size: int
    ws_ping_interval: float
    ws_ping_timeout: float
    ws_per_message_deflate: bool


SETTINGS: Final = WebSocketSettings(
    ws_max_size=MAX_FRAME_BYTES,
    # A client that vanished without closing holds one of its car's connections for the sum of these two at most.
    ws_ping_interval=20.0,
    ws_ping_timeout=20.0,
    # A compressed frame is expanded before `ws_max_size` is checked: a small one could fill the memory.
    ws_per_message_deflate=False,
)


class BoundedWebSocket(WSProtocol):
    """A connection that is aborted when its client has read nothing for `unread_s`.

    uvicorn answers each ping at once, whether or not the client reads: a client that sends pings and never reads
    the answers would fill the memory.
    """

    unread_s = UNREAD_S
    _abort_timer: asyncio.TimerHandle | None = None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        # uvicorn logs the path of each connection at INFO, and whoever knows the path drives the car
        self.logger = _logger

    def pause_writing(self) -> None:
        """Stop reading until the client reads, and give it `unread_s` to do so."""
        super().pause_writing()
        if self._abort_timer is None:
            self.transport.pause_reading()
            self._abort_timer = self.loop.call_later(self.unread_s, self.transport.abort)

    def resume_writing(self) -> None:
        """Read on, because the client has read."""
        super().resume_writing()
        self._cancel_abort()
        if not self.read_paused and not self.transport.is_closing():
            self.transport.resume_reading()

    def connection_lost(self, exc: Exception | None) -> None:
        """Cancel the timer: there is nothing left to abort."""
        self._cancel_abort()
        super().connection_lost(exc)

    def _cancel_abort(self) -> None:
        if self._abort_timer is not None:
            self._abort_timer.cancel()
            self._abort_timer = None
