"""The process of one live car: real time, one socket to the service that started it, and no other business.

It ends when the service closes the socket or is gone.
"""

import os
import resource
import select
import socket
import time
from typing import Final

from grader.live.pipe import CLOSE, HEAD, OPEN, TEXT, Parcel, pack, unpack_head
from grader.sim.driving import Car
from grader.sim.rosbridge.bridge import FIRST_ID, Out
from grader.sim.rosbridge.session import LiveSession

_NICENESS: Final = 5  # after requests, before gradings
_MEMORY_BYTES: Final = 1 << 30
_FILES: Final = 32
_PIECE: Final = 65_536
_LATE_NS: Final = 250_000_000
"""A process that was kept from running for longer than this, as by a laptop that slept, does not catch up: the car
has stood still meanwhile."""


class _Clock:
    """Real time since the start, in nanoseconds, without the stretches in which nothing ran."""

    def __init__(self) -> None:
        self._origin_ns = time.monotonic_ns()
        self._last_ns = 0

    def read(self) -> int:
        """Return the present instant."""
        return time.monotonic_ns() - self._origin_ns

    def read_after(self, expected_ns: int) -> int:
        """Return the present instant after a wait that should have ended at `expected_ns`; leave out a gap."""
        late_ns = self.read() - expected_ns
        if late_ns > _LATE_NS:
            self._origin_ns += late_ns
        return self.read()


def main(descriptor: int) -> int:
    """Drive the car until the socket is closed."""
    _bound()
    link = socket.socket(fileno=descriptor)
    link.setblocking(True)
    car = Car()
    session = LiveSession(car, time.time_ns())
    clock = _Clock()
    link.sendall(pack(Parcel(OPEN, 0)))
    kept = b""
    try:
        while True:
            now_ns, arrived = _wait(link, session, clock)
            if arrived == b"":
                return 0
            kept = _take(session, kept + (arrived or b""), now_ns)
            session.advance(now_ns)
            if out := session.take():
                link.sendall(b"".join(map(_packed, out)))
    except (BrokenPipeError, ConnectionResetError):
        return 0


def _bound() -> None:
    """Take away what a car does not need."""
    os.nice(_NICENESS)
    for kind, most in (
        (resource.RLIMIT_AS, _MEMORY_BYTES),
        (resource.RLIMIT_NOFILE, _FILES),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(kind, (most, most))


def _wait(link: socket.socket, session: LiveSession, clock: _Clock) -> tuple[int, bytes | None]:
    """Wait for frames or for the next instant at which something is due; return when it is, and the frames.

    No frames: None; the end: empty.
    """
    due_ns = session.next_due()
    begun_ns = clock.read()
    wait_s = None if due_ns is None else max(due_ns - begun_ns, 0) / 1e9
    ready, _, _ = select.select([link], [], [], wait_s)
    expected_ns = begun_ns if due_ns is None else max(due_ns, begun_ns)
    now_ns = clock.read() if ready and due_ns is None else clock.read_after(expected_ns)
    return now_ns, link.recv(_PIECE) if ready else None


def _take(session: LiveSession, data: bytes, now_ns: int) -> bytes:
    """Act on the whole messages in `data`; return the rest."""
    start = 0
    while len(data) - start >= HEAD.size:
        length, parcel = unpack_head(data[start : start + HEAD.size])
        end = start + HEAD.size + length
        if end > len(data):
            break
        if parcel.kind == OPEN:
            session.open(parcel.client)
        elif parcel.kind == CLOSE:
            session.close(parcel.client)
        else:
            session.receive(parcel.client, data[start + HEAD.size : end], now_ns)
        start = end
    return data[start:]


def _packed(out: Out) -> bytes:
    if out.close:
        return pack(Parcel(CLOSE, out.client, out.close, 0, out.text))
    slot = out.slot - FIRST_ID + 1 if out.slot else 0
    return pack(Parcel(TEXT, out.client, slot % 65_536, out.depth, out.text))
