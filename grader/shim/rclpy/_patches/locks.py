"""The kinds of lock, built on the kernel: waiting for one is virtual.

Only one thread runs at a time and it is never taken off between two of these statements, so a plain
attribute is enough to hold a lock.
"""

from __future__ import annotations

import _thread

from rclpy._kernel import Thread, kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


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
        """Take the lock back at the end of a `Condition.wait`, which nothing may interrupt half-way."""
        interrupt: KeyboardInterrupt | None = None
        while self._owner is not None:
            try:
                kernel.wait(self._is_free)
            except KeyboardInterrupt as error:
                interrupt = error
        self._count, self._owner = saved
        if interrupt is not None:
            raise interrupt

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


class SemLock:
    """`_multiprocessing.SemLock`: what the locks of `multiprocessing` are made of.

    In the one process that there is they keep threads apart, as those of `multiprocessing.pool.ThreadPool`.
    """

    SEM_VALUE_MAX = 2**31 - 1
    _RECURSIVE = 0

    def __init__(self, kind: int, value: int, maxvalue: int, name: str, unlink: bool) -> None:
        self.handle = id(self)
        self.kind = kind
        self.maxvalue = maxvalue
        self.name = None if unlink else name
        self._value = value
        self._holds = 0
        self._owner: Thread | None = None

    def acquire(self, block: bool = True, timeout: float | None = None) -> bool:
        """Take one, waiting for it up to `timeout` seconds; None: for ever."""
        if self.kind == self._RECURSIVE and self._is_mine():
            self._holds += 1
            return True
        if not self._value:
            seconds = (None if timeout is None else max(0.0, timeout)) if block else 0.0
            if seconds == 0.0:
                kernel.charge()
                if not self._value:
                    return False
            elif not kernel.wait(self._is_free, deadline_after(seconds)):
                return False
        self._value -= 1
        self._holds += 1
        self._owner = kernel.running
        return True

    def _is_free(self) -> bool:
        return self._value > 0

    def release(self) -> None:
        """Give one back.

        Raises AssertionError: it is another thread's. ValueError: all are there.
        """
        if self.kind == self._RECURSIVE:
            if not self._is_mine():
                raise AssertionError("attempt to release recursive lock not owned by thread")
            if self._holds > 1:
                self._holds -= 1
                return
        elif self._value >= self.maxvalue:
            raise ValueError("semaphore or lock released too many times")
        self._value += 1
        self._holds -= 1

    def _count(self) -> int:
        return self._holds

    def _is_mine(self) -> bool:
        return self._holds > 0 and self._owner is kernel.running

    def _get_value(self) -> int:
        return self._value

    def _is_zero(self) -> bool:
        return not self._value

    def _after_fork(self) -> None:
        self._holds = 0

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()


def patch_multiprocessing(module: Any) -> None:
    """Let locks be made of virtual ones: the system has no semaphores here."""
    module.SemLock = SemLock
