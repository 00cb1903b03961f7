"""Threads and locks under the kernel.

One lock class replaces `_thread.allocate_lock`, one `_thread.RLock`; what `threading`, `queue`,
`concurrent.futures` and the import system build from them becomes virtual by itself. A thread is a real one
that runs only while it holds the kernel's baton.
"""

import _thread
import sys
from collections.abc import Callable
from typing import Any

from rclpy._kernel import kernel
from rclpy._scheduler import Thread

_start_os_thread = _thread.start_new_thread
_os_ident = _thread.get_ident


def deadline_after(timeout: float | None) -> int | None:
    """Return the instant `timeout` seconds from now; None: for ever."""
    if timeout is None:
        return None
    return kernel.now_ns + max(0, round(timeout * 1e9))


def _check_timeout(blocking: bool, timeout: float) -> float | None:
    """Return the seconds to wait at most, None: for ever; refuse what `lock.acquire` refuses."""
    if not blocking:
        if timeout != -1:
            raise ValueError("can't specify a timeout for a non-blocking call")
        return 0.0
    if timeout == -1:
        return None
    if timeout != timeout:  # noqa: PLR0124 - NaN
        raise ValueError("Invalid value NaN (not a number)")
    if timeout < 0:
        raise ValueError("timeout value must be a non-negative number")
    if timeout > _thread.TIMEOUT_MAX:
        raise OverflowError("timeout value is too large")
    return timeout


class Lock:
    """`_thread.lock`: a lock that any thread may release; waiting for it is virtual."""

    __slots__ = ("__weakref__", "_held")

    def __init__(self) -> None:
        self._held = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        if self._held or timeout != -1:
            return self._acquire(blocking, timeout)
        self._held = True
        return True

    def _acquire(self, blocking: bool, timeout: float) -> bool:
        seconds = _check_timeout(blocking, timeout)
        if seconds is not None and seconds <= 0:
            kernel.charge()
            if self._held:
                return False
        elif not kernel.wait(self._is_free, deadline_after(seconds)):
            return False
        self._held = True
        return True

    def _is_free(self) -> bool:
        return not self._held

    def release(self) -> None:
        if not self._held:
            raise RuntimeError("release unlocked lock")
        self._held = False

    def locked(self) -> bool:
        return self._held

    def _at_fork_reinit(self) -> None:
        self._held = False

    def __enter__(self) -> bool:
        if self._held:
            return self._acquire(True, -1)
        self._held = True
        return True

    def __exit__(self, *_: object) -> None:
        self.release()

    def __repr__(self) -> str:
        return f"<{'locked' if self._held else 'unlocked'} _thread.lock object at {id(self):#x}>"

    acquire_lock = acquire
    release_lock = release
    locked_lock = locked


class RLock:
    """`_thread.RLock`: its owner may acquire it again."""

    __slots__ = ("__weakref__", "_count", "_owner")

    def __init__(self) -> None:
        self._owner: Thread | None = None
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        me = kernel.running
        if self._owner is me:
            self._count += 1
            return True
        seconds = None if timeout == -1 and blocking else _check_timeout(blocking, timeout)
        if self._owner is not None:
            if seconds is not None and seconds <= 0:
                kernel.charge()
                if self._owner is not None:
                    return False
            elif not kernel.wait(self._is_free, deadline_after(seconds)):
                return False
        self._owner = me
        self._count = 1
        return True

    def _is_free(self) -> bool:
        return self._owner is None

    def release(self) -> None:
        if self._owner is not kernel.running:
            raise RuntimeError("cannot release un-acquired lock")
        self._count -= 1
        if not self._count:
            self._owner = None

    def locked(self) -> bool:
        return self._owner is not None

    def _is_owned(self) -> bool:
        return self._owner is kernel.running

    def _recursion_count(self) -> int:
        return self._count if self._owner is kernel.running else 0

    def _release_save(self) -> tuple[int, Thread | None]:
        if not self._count:
            raise RuntimeError("cannot release un-acquired lock")
        saved = (self._count, self._owner)
        self._owner = None
        self._count = 0
        return saved

    def _acquire_restore(self, saved: tuple[int, Thread | None]) -> None:
        if self._owner is not None:
            kernel.wait(self._is_free)
        self._count, self._owner = saved

    def _at_fork_reinit(self) -> None:
        self._owner = None
        self._count = 0

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def __repr__(self) -> str:
        state = "unlocked" if self._owner is None else "locked"
        owner = 0 if self._owner is None else self._owner.ident
        return f"<{state} _thread.RLock object owner={owner} count={self._count} at {id(self):#x}>"


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
