"""uvicorn's websocket, bounded: it reads nothing more from a client that does not read what it was sent."""

import asyncio
import logging
from typing import Any, Final, TypedDict

from uvicorn.protocols.websockets.wsproto_impl import WSProtocol

from grader.sim.rosbridge.frames import MAX_FRAME_BYTES

UNREAD_S: Final = 10.0
_quiet: Final = logging.getLogger(__name__)
_quiet.setLevel(logging.WARNING)


class WebSocketSettings(TypedDict):
    """Arguments of uvicorn's configuration."""

    ws_max_size: int
    ws_ping_interval: float
    ws_ping_timeout: float
    ws_per_message_deflate: bool


SETTINGS: Final = WebSocketSettings(
    ws_max_size=MAX_FRAME_BYTES,
    ws_ping_interval=20.0,
    ws_ping_timeout=20.0,
    ws_per_message_deflate=False,  # a small frame could grow to any size
)


class BoundedWebSocket(WSProtocol):
    """A connection that ends when its client has not read for a while.

    Pings are answered by uvicorn itself: without this, a client that sends them and never reads fills the memory.
    """

    unread_s = UNREAD_S
    _unread: asyncio.TimerHandle | None = None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.logger = _quiet  # its lines would tell the addresses, which open cars

    def pause_writing(self) -> None:
        """Wait for the client to read."""
        super().pause_writing()
        if self._unread is None:
            self.transport.pause_reading()
            self._unread = self.loop.call_later(self.unread_s, self.transport.abort)

    def resume_writing(self) -> None:
        """Go on."""
        super().resume_writing()
        self._stop_waiting()
        if not self.read_paused and not self.transport.is_closing():
            self.transport.resume_reading()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._stop_waiting()
        super().connection_lost(exc)

    def _stop_waiting(self) -> None:
        if self._unread is not None:
            self._unread.cancel()
            self._unread = None
