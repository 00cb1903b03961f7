"""A websocket between a client and its live car, as an ASGI application sees it, and as uvicorn bounds it."""

import asyncio
import contextlib
import json
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any, Final, TypeAlias
from urllib.parse import urlsplit

from grader.live.car import TRY_AGAIN, LiveCar, LiveClient
from grader.sim.rosbridge.bridge import BAD_CLIENT

Scope: TypeAlias = MutableMapping[str, Any]
Receive: TypeAlias = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send: TypeAlias = Callable[[MutableMapping[str, Any]], Awaitable[None]]

FRAMES_PER_S: Final = 200.0
FRAMES_AT_ONCE: Final = 400
BYTES_PER_S: Final = 131_072.0
BYTES_AT_ONCE: Final = 524_288
SEND_S: Final = 5.0
_TOO_MUCH: Final = f"more than {BYTES_PER_S / 1024:.0f} KiB a second"
_TOO_FAST: Final = f"more than {FRAMES_PER_S:.0f} frames a second: let the loop that publishes sleep"


def is_own_origin(scope: Scope, allowed: Callable[[str], bool] = lambda origin: False) -> bool:
    """Return whether a websocket was opened by no browser, by a page of the same host, or by an allowed origin.

    Browsers let any page open a websocket to any host, and send cookies along; but they say whose page it is.
    """
    headers = dict(scope["headers"])
    origin = headers.get(b"origin", b"").decode("latin-1")
    if not origin or allowed(origin):
        return True
    host = headers.get(b"host", b"").decode("latin-1")
    return bool(host) and urlsplit(origin).netloc.lower() == host.lower()


async def refuse(send: Send, status: int, code: str) -> None:
    """Answer the request for a websocket with an HTTP status instead."""
    body = json.dumps({"type": f"/api/v1/problems/{code}", "status": status, "code": code}).encode()
    headers = [(b"content-type", b"application/problem+json"), (b"content-length", str(len(body)).encode())]
    await send({"type": "websocket.http.response.start", "status": status, "headers": headers})
    await send({"type": "websocket.http.response.body", "body": body})


async def serve(receive: Receive, send: Send, car: LiveCar) -> None:
    """Connect a websocket that waits for its handshake with a car, until one of the two ends."""
    await receive()  # websocket.connect
    client = car.join()
    if client is None:
        await refuse(send, 503, "live_full")
        return
    sending: asyncio.Task[None] | None = None
    try:
        await send({"type": "websocket.accept"})
        sending = asyncio.create_task(_send_all(send, client))
        await _receive_all(receive, client)
    finally:
        client.leave()
        if sending is not None:
            client.end(1000, "")
            await asyncio.wait([sending], timeout=SEND_S)
            sending.cancel()
            with contextlib.suppress(asyncio.CancelledError, OSError, RuntimeError):
                await sending


async def _receive_all(receive: Receive, client: LiveClient) -> None:
    """Hand frames over until the connection ends. A client that sends too many is disconnected."""
    clock = asyncio.get_running_loop().time
    frames = _Allowance(FRAMES_PER_S, FRAMES_AT_ONCE, clock())
    size = _Allowance(BYTES_PER_S, BYTES_AT_ONCE, clock())
    while (event := await receive())["type"] == "websocket.receive":
        text = event.get("text")
        data = event.get("bytes") or b"" if text is None else text.encode(errors="replace")
        if not frames.take(1.0, clock()):
            client.end(BAD_CLIENT, _TOO_FAST)
        elif not size.take(len(data), clock()):
            client.end(BAD_CLIENT, _TOO_MUCH)
        elif not client.closed:
            client.send(data)


class _Allowance:
    """A token bucket: an amount per second, and a largest amount at once."""

    def __init__(self, per_s: float, at_once: float, now_s: float) -> None:
        self._per_s, self._most, self._left, self._at_s = per_s, at_once, at_once, now_s

    def take(self, amount: float, now_s: float) -> bool:
        """Take `amount`; false when there is not so much left."""
        gained = (now_s - self._at_s) * self._per_s
        self._left, self._at_s = min(self._left + gained, self._most) - amount, now_s
        return self._left >= 0.0


async def _send_all(send: Send, client: LiveClient) -> None:
    """Send what the car has for the client, then close. A client that does not read is disconnected."""
    with contextlib.suppress(OSError):  # uvicorn's, of a connection that has ended
        try:
            while (text := await client.next()) is not None:
                event = {"type": "websocket.send", "text": text.decode()}
                await asyncio.wait_for(send(event), SEND_S)
        except TimeoutError:
            client.end(TRY_AGAIN, "this client reads too slowly")
        closing = {"type": "websocket.close", "code": client.closed, "reason": client.reason[:100]}
        await asyncio.wait_for(send(closing), SEND_S)
