"""Threads and locks under the kernel.

One lock class replaces `_thread.allocate_lock`, one `_thread.RLock`; what `threading`, `queue`,
`concurrent.futures` and the import system build from them becomes virtual by itself. A thread is a real one
that runs only while it holds the kernel's baton.
"""

from __future__ import annotations

import _thread
import sys

from rclpy._kernel import kernel
from rclpy._locks import Lock, RLock, deadline_after
from rclpy._scheduler import Thread

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_start_os_thread = _thread.start_new_thread
_os_ident = _thread.get_ident


class ThreadHandle:
    """`_thread._ThreadHandle` of Python 3.13: lets others wait for the end of a thread."""

    def __init__(self) -> None:
        self.ident = 0
        self._done = False
        self._thread: Thread | None = None

    def start(self, thread: Thread) -> None:
        """Stand for `thread` from now on."""
        if self._thread is not None:
            raise RuntimeError("thread already started")
        self._thread = thread
        self.ident = thread.ident
        thread.sentinel = self

    def join(self, timeout: float | None = None) -> None:
        if self._thread is kernel.running:
            raise RuntimeError("Cannot join current thread")
        kernel.wait(self.is_done, deadline_after(timeout))

    def is_done(self) -> bool:
        return self._done

    def _set_done(self) -> None:
        self._done = True

    def locked(self) -> bool:
        return not self._done

    release = _set_done


def get_ident() -> int:
    """Return the identifier of the running thread, the same in each run."""
    return kernel.running.ident


def get_native_id() -> int:
    """Return what the script sees as the kernel's id of the running thread."""
    return 4242 + (kernel.running.ident - kernel.main.ident) // 0x1000


def start_new_thread(
    function: Callable[..., object], args: tuple[Any, ...], kwargs: dict[str, Any] | None = None, /
) -> int:
    """Start a thread under the kernel; it first runs when the starting thread blocks."""
    owner = getattr(function, "__self__", None)
    thread = kernel.new_thread(str(getattr(owner, "name", "thread")), bool(getattr(owner, "daemon", True)))
    _start(thread, function, args, kwargs or {})
    return thread.ident


def start_joinable_thread(
    function: Callable[[], object], handle: ThreadHandle | None = None, daemon: bool = True
) -> ThreadHandle:
    """`_thread.start_joinable_thread` of Python 3.13."""
    owner = getattr(function, "__self__", None)
    thread = kernel.new_thread(str(getattr(owner, "name", "thread")), daemon)
    handle = handle or ThreadHandle()
    handle.start(thread)
    _start(thread, function, (), {})
    return handle


def _start(
    thread: Thread, function: Callable[..., object], args: tuple[Any, ...], kwargs: dict[str, Any]
) -> None:
    _start_os_thread(_run, (thread, [(function, args, kwargs)]))
    kernel.start_thread(thread)


def _run(thread: Thread, work: list[tuple[Callable[..., object], tuple[Any, ...], dict[str, Any]]]) -> None:
    thread.os_ident = _os_ident()
    thread.baton.acquire()
    kernel.replan()
    try:
        _call(work)
    finally:
        kernel.end_thread(thread)


def _call(work: list[tuple[Callable[..., object], tuple[Any, ...], dict[str, Any]]]) -> None:
    """Run the thread's function and drop every reference to it while the thread still has its turn."""
    function, args, kwargs = work.pop()
    try:
        function(*args, **kwargs)
    except SystemExit:
        pass
    except BaseException as error:
        from rclpy._report import print_exception

        print(f"Exception ignored in thread started by: {function!r}", file=sys.stderr)  # noqa: T201
        print_exception(error)


def set_sentinel() -> Lock:
    """`_thread._set_sentinel` up to Python 3.12: a lock released when the calling thread has ended."""
    lock = Lock()
    kernel.running.sentinel = lock
    return lock


def make_thread_handle(ident: int) -> ThreadHandle:
    """`_thread._make_thread_handle` of Python 3.13."""
    handle = ThreadHandle()
    handle.ident = ident
    return handle


def interrupt_main(number: int = 2, /) -> None:
    """Let a signal arrive at the main thread."""
    kernel.raise_signal(number)


REPLACED: dict[str, object] = {
    "allocate_lock": Lock,
    "allocate": Lock,
    "LockType": Lock,
    "lock": Lock,
    "RLock": RLock,
    "get_ident": get_ident,
    "get_native_id": get_native_id,
    "start_new_thread": start_new_thread,
    "start_new": start_new_thread,
    "start_joinable_thread": start_joinable_thread,
    "_set_sentinel": set_sentinel,
    "_ThreadHandle": ThreadHandle,
    "_make_thread_handle": make_thread_handle,
    "interrupt_main": interrupt_main,
}
"""Names of `_thread` (of Python 3.11 to 3.13) and what stands in for them."""
