"""The service's side of a live car: its process, and the frames that wait until its clients read them."""

import asyncio
import contextlib
import os
import secrets
import signal
import socket
import sys
from collections import deque
from collections.abc import Callable
from typing import Final

from grader.contracts.errors import InfrastructureError
from grader.grading.launch import import_path
from grader.live.pipe import CLOSE, HEAD, OPEN, TEXT, Parcel, pack, unpack_head

TRY_AGAIN: Final = 1013
"""Close code of a websocket whose client reads too slowly, or whose car ended through a fault of ours."""
GONE: Final = 1001
"""Close code of a websocket whose car has ended: its time is over, or the service stops."""

START_S: Final = 20.0
MOST_UNREAD: Final = 256
"""So many frames that belong to no topic may wait for a client."""

_ENVIRONMENT: Final = ("PATH", "HOME", "LANG", "TMPDIR", "PYTHONPATH", "VIRTUAL_ENV")
_THREADS: Final = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_BOOTSTRAP: Final = (
    "import os, sys; sys.path[:] = sys.argv[1].split(os.pathsep); "
    "from grader.live.child import main; sys.exit(main(int(sys.argv[2])))"
)
_MOST_BEHIND: Final = 1 << 20  # bytes that the process may leave unread before it counts as stuck


class LiveClient:
    """One connection to a car.

    Attributes:
        closed: 0, or the status with which the connection is to be closed.
        reason: why, in words.
    """

    def __init__(self, number: int, car: "LiveCar") -> None:
        self.number = number
        self.closed = 0
        self.reason = ""
        self._car = car
        self._waiting: deque[tuple[int, bytes]] = deque()  # slot and frame
        self._counts: dict[int, int] = {}  # of the waiting ones, by slot; slot 0: they belong to no topic
        self._news = asyncio.Event()

    def send(self, text: bytes) -> None:
        """Hand a frame of the client to the car."""
        self._car.tell(Parcel(TEXT, self.number, text=text))

    async def next(self) -> bytes | None:
        """Return the next frame for the client; None when the connection is to be closed."""
        while not self._waiting:
            if self.closed:
                return None
            self._news.clear()
            await self._news.wait()
        slot, text = self._waiting.popleft()
        self._counts[slot] -= 1
        if not self._counts[slot]:
            del self._counts[slot]
        return text

    def leave(self) -> None:
        """Note that the connection has ended."""
        self._car.leave(self)

    def take(self, parcel: Parcel) -> None:
        """Keep a frame until the client reads it. Of a topic's frames only the newest `depth` are kept."""
        slot = parcel.slot
        if slot and self._counts.get(slot, 0) >= parcel.depth:
            oldest = next(index for index, (kept, _) in enumerate(self._waiting) if kept == slot)
            del self._waiting[oldest]
            self._counts[slot] -= 1
        elif not slot and self._counts.get(0, 0) >= MOST_UNREAD:
            self.end(TRY_AGAIN, "this client reads too slowly")
            return
        self._waiting.append((slot, parcel.text))
        self._counts[slot] = self._counts.get(slot, 0) + 1
        self._news.set()

    def end(self, status: int, reason: str) -> None:
        """Have the connection closed. If the car is gone, the client still gets what waits for it."""
        if not self.closed:
            self.closed, self.reason = status, reason
        if status != GONE:
            self._waiting.clear()
            self._counts.clear()
        self._news.set()


class LiveCar:
    """A car in a process of its own.

    Attributes:
        clients: how many are connected.
        most_clients: how many may be.
        on_join, on_empty, on_end: called when a client comes, when the last one has gone, when the car has ended.
    """

    def __init__(self, most_clients: int) -> None:
        self.most_clients = most_clients
        self.on_join: Callable[[], None] = lambda: None
        self.on_empty: Callable[[], None] = lambda: None
        self.on_end: Callable[[], None] = lambda: None
        self._clients: dict[int, LiveClient] = {}
        self._numbers = 0
        self._pid = 0
        self._ended = False
        self._writer: asyncio.StreamWriter | None = None
        self._reading: asyncio.Task[None] | None = None

    @property
    def clients(self) -> int:
        """How many are connected."""
        return len(self._clients)

    @property
    def alive(self) -> bool:
        """Whether it can be driven."""
        return self._writer is not None

    async def start(self) -> None:
        """Start the process and wait until the car stands in its world.

        Raises InfrastructureError: the process could not be started, or did not begin in time.
        """
        self._ended = False
        ours, theirs = socket.socketpair()
        try:
            self._pid = _spawn(theirs.fileno())
        except OSError as error:
            ours.close()
            raise InfrastructureError(f"the process of a live car could not be started: {error}") from error
        finally:
            theirs.close()
        reader, self._writer = await asyncio.open_connection(sock=ours)
        if self._ended:  # by a call of `end` in the meantime
            self.end()
        try:
            await asyncio.wait_for(reader.readexactly(HEAD.size), START_S)
        except (TimeoutError, asyncio.IncompleteReadError, ConnectionError) as error:
            self.end()
            raise InfrastructureError("the process of a live car did not begin") from error
        self._reading = asyncio.get_running_loop().create_task(self._read(reader))

    def join(self) -> LiveClient | None:
        """Return a new client; None where there are too many, or the car has ended."""
        if not self.alive or len(self._clients) >= self.most_clients:
            return None
        self._numbers += 1
        client = self._clients[self._numbers] = LiveClient(self._numbers, self)
        self.tell(Parcel(OPEN, client.number))
        self.on_join()
        return client

    def leave(self, client: LiveClient) -> None:
        """Forget a client."""
        if self._clients.pop(client.number, None) is not None:
            self.tell(Parcel(CLOSE, client.number))
            if not self._clients:
                self.on_empty()

    def tell(self, parcel: Parcel) -> None:
        """Send a message to the process; end a process that no longer reads."""
        if self._writer is None:
            return
        self._writer.write(pack(parcel))
        if self._writer.transport.get_write_buffer_size() > _MOST_BEHIND:
            self.end(TRY_AGAIN, "the car does not answer")

    def end(self, status: int = GONE, reason: str = "the car has ended") -> None:
        """End the process and all connections. A car that is being started ends as soon as it can."""
        self._ended = True
        for client in self._clients.values():
            client.end(status, reason)
        if self._writer is not None:
            self._writer.transport.abort()
            self._writer = None
            _kill(self._pid)
            self.on_end()

    async def _read(self, reader: asyncio.StreamReader) -> None:
        with contextlib.suppress(asyncio.IncompleteReadError, ConnectionError):
            while True:
                length, parcel = unpack_head(await reader.readexactly(HEAD.size))
                text = await reader.readexactly(length)
                client = self._clients.get(parcel.client)
                if client is None:
                    continue
                if parcel.kind == CLOSE:
                    client.end(parcel.slot, text.decode(errors="replace"))
                else:
                    client.take(parcel._replace(text=text))
        self.end(TRY_AGAIN, "the car has ended unexpectedly")


def new_key() -> str:
    """Return a key that opens one car: 128 random bits."""
    return secrets.token_urlsafe(16)


def _spawn(descriptor: int) -> int:
    environment = {name: os.environ[name] for name in _ENVIRONMENT if name in os.environ}
    return os.posix_spawn(
        sys.executable,
        [sys.executable, "-I", "-S", "-c", _BOOTSTRAP, import_path(), str(descriptor)],
        environment | _THREADS,
        file_actions=[
            (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
            (os.POSIX_SPAWN_DUP2, descriptor, descriptor),  # inherited by this process alone
        ],
        setsid=True,
    )


def _kill(pid: int) -> None:
    """Kill a process that this one started, and reap it."""
    with contextlib.suppress(ProcessLookupError, ChildProcessError):
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
