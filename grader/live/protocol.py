"""uvicorn's websocket with a bound: it stops reading from a client that does not read."""

import asyncio
import logging
from typing import Any, Final, TypedDict

from uvicorn.protocols.websockets.wsproto_impl import WSProtocol

from grader.sim.rosbridge.frames import MAX_FRAME_BYTES

UNREAD_S: Final = 10.0
"""How long a client may leave unread what it was sent before its connection ends."""

_warnings_only: Final = logging.getLogger(__name__)
_warnings_only.setLevel(logging.WARNING)


class WebSocketSettings(TypedDict):
    """Arguments of uvicorn's configuration."""

    ws_max_size: int
    ws_ping_interval: float
    ws_ping_timeout: float
    ws_per_message_deflate: bool


SETTINGS: Final = WebSocketSettings(
    ws_max_size=MAX_FRAME_BYTES,
    ws_ping_interval=20.0,  # uvicorn's own default, like the timeout
    ws_ping_timeout=20.0,
    ws_per_message_deflate=False,  # a small frame could grow to any size
)


class BoundedWebSocket(WSProtocol):
    """A connection that ends when its client has not read for `unread_s`.

    uvicorn answers pings by itself: without this bound, a client could fill the memory with them.
    """

    unread_s = UNREAD_S
    _timer: asyncio.TimerHandle | None = None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.logger = _warnings_only  # uvicorn logs addresses, and an address opens a car

    def pause_writing(self) -> None:
        """Stop reading, and give the client `unread_s` to read."""
        super().pause_writing()
        if self._timer is None:
            self.transport.pause_reading()
            self._timer = self.loop.call_later(self.unread_s, self.transport.abort)

    def resume_writing(self) -> None:
        """Read again: the client has read."""
        super().resume_writing()
        self._cancel_timer()
        if not self.read_paused and not self.transport.is_closing():
            self.transport.resume_reading()

    def connection_lost(self, exc: Exception | None) -> None:
        """Cancel the timer, which would abort a connection that is gone."""
        self._cancel_timer()
        super().connection_lost(exc)

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
