"""`select`, `poll` and `epoll` with virtual timeouts.

The descriptors are real: pipes and socket pairs that only the script itself can write to. A waiting thread never
blocks in the operating system. Whenever the kernel looks for a thread to run, it asks there, with timeout 0.
"""

from __future__ import annotations

import select

from rclpy._kernel import kernel
from rclpy._patches.locks import deadline_after

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType
    from typing import Any

_SURE_BYTES = 4_096  # as many as a pipe takes at once, where it takes any
_select, _poll = select.select, select.poll
_epoll: Any = getattr(select, "epoll", None)  # Linux only


def _await(ask: Callable[[], list[Any]], timeout: float | None, why: str) -> list[Any]:
    """Return the first answer of `ask` that is not empty; an empty list once the timeout has passed."""
    answer: list[Any] = []

    def ready() -> bool:
        if not answer:
            answer.extend(ask())
        return bool(answer)

    if timeout is not None and timeout <= 0:
        kernel.charge()
        ready()
    else:
        # `idle`: without a timeout this is an event loop at rest, which a signal may still end. It is no stall.
        kernel.wait(ready, deadline_after(timeout), why, idle=True)
    return answer


def virtual_select(rlist: Any, wlist: Any, xlist: Any, timeout: float | None = None, /) -> Any:
    """`select.select`."""
    if timeout is not None and timeout < 0:
        raise ValueError("timeout must be non-negative")

    def ask() -> list[Any]:
        lists = _select(rlist, wlist, xlist, 0)
        return [lists] if any(lists) else []

    answer = _await(ask, timeout, "select() waits for a descriptor")
    return answer[0] if answer else ([], [], [])


class VirtualPoll:
    """`select.poll()`."""

    def __init__(self) -> None:
        self._real = _poll()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def poll(self, timeout: float | None = None, /) -> list[tuple[int, int]]:
        seconds = None if timeout is None or timeout < 0 else timeout / 1000
        return _await(lambda: self._real.poll(0), seconds, "poll() waits for a descriptor")


class VirtualEpoll:
    """`select.epoll`."""

    def __init__(self, sizehint: int = -1, flags: int = 0) -> None:
        self._real = _epoll(sizehint, flags)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def __enter__(self) -> VirtualEpoll:
        self._real.__enter__()
        return self

    def __exit__(self, *details: Any) -> None:
        self._real.__exit__(*details)

    def poll(self, timeout: float | None = None, maxevents: int = -1) -> list[tuple[int, int]]:
        seconds = None if timeout is None or timeout < 0 else timeout
        return _await(lambda: self._real.poll(0, maxevents), seconds, "epoll waits for a descriptor")


def patch_select(module: ModuleType) -> None:
    """Replace the three ways to wait for descriptors."""
    target: Any = module
    target.select = virtual_select
    target.poll = VirtualPoll
    if _epoll is not None:
        target.epoll = VirtualEpoll


def patch_selectors(module: ModuleType) -> None:
    """Replace the functions that the selector classes took from `select` when they were defined."""
    target: Any = module
    target.PollSelector._selector_cls = VirtualPoll
    target.SelectSelector._select = staticmethod(virtual_select)
    if _epoll is not None:
        target.EpollSelector._selector_cls = VirtualEpoll
    else:
        # Off Linux the default is kqueue, which would wait in real time.
        target.DefaultSelector = target.PollSelector


def patch_connection(module: ModuleType) -> None:
    """Let the connections of `multiprocessing` wait for the other end without stopping it, as it is a thread."""
    target: Any = module
    connection = target.Connection
    read, write = connection._read, connection._write

    def read_later(handle: int, size: int) -> Any:
        virtual_select([handle], [], [])
        return read(handle, size)

    def write_later(handle: int, data: Any) -> Any:
        virtual_select([], [handle], [])
        return write(handle, data[:_SURE_BYTES])

    connection._recv.__defaults__ = (read_later,)
    connection._send.__defaults__ = (write_later,)
