"""Threads under the kernel, and what the modules built on them need.

One lock class replaces `_thread.allocate_lock`, one `_thread.RLock`; what `threading`, `queue`,
`concurrent.futures` and the import system build from them becomes virtual by itself. A thread is a real one
that runs only while it holds the kernel's baton.
"""

from __future__ import annotations

import _thread
import sys
import time

from rclpy._kernel import Thread, kernel
from rclpy._patches.locks import Lock, RLock, deadline_after

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType
    from typing import Any

_start_os_thread = _thread.start_new_thread
_os_ident = _thread.get_ident
_count_os_threads = _thread._count
_stack_size = _thread.stack_size
_pause = time.sleep  # in real time
# The host may have no thread to spare for some milliseconds, because of another script: then starting one is tried
# again. A script that has more than a few threads has reached its own limit.
_FEW_THREADS = 32
_TRIES = 20
_PAUSE_S = 0.02

_USUAL_STACK_BYTES = 8 << 20
_MOST_STACKS_BYTES = 1 << 28
"""Of all threads together, if the script wants larger ones than usual: half of the memory that it gets by default.

A thread whose stack took the rest would start, and the next allocation anywhere would fail, even between turns.
"""


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
    start(thread, function, args, kwargs or {})
    return thread.ident


def start_joinable_thread(
    function: Callable[[], object], handle: ThreadHandle | None = None, daemon: bool = True
) -> ThreadHandle:
    """`_thread.start_joinable_thread` of Python 3.13."""
    owner = getattr(function, "__self__", None)
    thread = kernel.new_thread(str(getattr(owner, "name", "thread")), daemon)
    handle = handle or ThreadHandle()
    handle.start(thread)
    start(thread, function, (), {})
    return handle


def start(
    thread: Thread, function: Callable[..., object], args: tuple[Any, ...], kwargs: dict[str, Any]
) -> None:
    """Start `thread`, which calls the function when its turn comes."""
    from rclpy._link import link

    stack_bytes = _stack_size()
    _stack_size(stack_bytes)  # to ask for it has set it to the system's
    if stack_bytes > _USUAL_STACK_BYTES and stack_bytes * (_count_os_threads() + 1) > _MOST_STACKS_BYTES:
        raise RuntimeError("can't start new thread")
    if link.note_once("threads"):
        link.flush()  # its threads are kept on one core from now on
    work = (thread, [(function, args, kwargs)])
    for _ in range(_TRIES):
        try:
            _start_os_thread(_run, work)
            break
        except RuntimeError:
            if _count_os_threads() > _FEW_THREADS:
                raise
            _pause(_PAUSE_S)
    else:
        _start_os_thread(_run, work)
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
        from rclpy._patches.tracebacks import print_exception

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
    """Deliver a signal to the main thread."""
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


# What the modules built on `_thread` need besides ----------------------------------------------------


def patch_threading(threading: ModuleType) -> None:
    """Renew the module's own locks, give the main thread its virtual identifier, charge for questions."""
    module: Any = threading
    module.Lock = Lock
    module._allocate_lock = Lock
    module._CRLock = RLock
    module._active_limbo_lock = RLock()
    if hasattr(module, "_shutdown_locks_lock"):
        module._shutdown_locks_lock = Lock()
    main = module.main_thread()
    active = module._active
    active.pop(main._ident, None)
    main._ident = kernel.main.ident
    main._native_id = get_native_id()
    active[main._ident] = main
    main._started._cond = module.Condition(Lock())
    if hasattr(main, "_tstate_lock"):
        main._tstate_lock = Lock()
        main._tstate_lock.acquire()
    else:
        main._handle = make_thread_handle(main._ident)
    module.Event.is_set = _charged(module.Event.is_set)
    module.Thread.is_alive = _charged(module.Thread.is_alive)
    module.excepthook = module.__excepthook__ = excepthook


def end_main_thread(threading: ModuleType) -> None:
    """Wake threads that join the main thread: the script's last line has run."""
    module: Any = threading
    main = module.main_thread()
    if hasattr(main, "_tstate_lock"):
        if main._tstate_lock is not None:
            main._tstate_lock.release()
            main._stop()
    else:
        main._handle._set_done()


def _charged(question: Callable[[Any], bool]) -> Callable[[Any], bool]:
    """Return a method that charges virtual time, then does what `question` does: a loop that asks must end."""

    def ask(self: Any) -> bool:
        kernel.charge()
        return question(self)

    ask.__name__ = question.__name__
    ask.__qualname__ = question.__qualname__
    ask.__doc__ = question.__doc__
    return ask


def excepthook(args: Any, /) -> None:
    """Report the exception that ended a thread, as `threading.excepthook` does."""
    from rclpy._link import link
    from rclpy._patches import tracebacks

    if args.exc_type is SystemExit:
        return
    name = args.thread.name if args.thread is not None else str(get_ident())
    error = args.exc_value if args.exc_value is not None else args.exc_type()
    print(f"Exception in thread {name}:", file=sys.stderr)  # noqa: T201
    line = tracebacks.line_of(error)
    if not line:  # Python's printer leaves out the heading of no frames
        print("Traceback (most recent call last):", file=sys.stderr)  # noqa: T201
    tracebacks.print_exception(error)
    place = f"{name}, line {line}" if line else name
    link.note("thread_exception", f"{place}: {tracebacks.one_line(error)}")


def patch_queue(queue: ModuleType) -> None:
    """Use the SimpleQueue that is written in Python, which is built from the replaced locks."""
    module: Any = queue
    module.SimpleQueue = module._PySimpleQueue
    native: Any = sys.modules.get("_queue")
    if native is not None:
        native.SimpleQueue = module._PySimpleQueue


def patch_logging(logging: ModuleType) -> None:
    """Renew the locks of the module and of its handlers."""
    module: Any = logging
    module._lock = RLock()
    for reference in module._handlerList:
        handler = reference()
        if handler is not None:
            handler.createLock()


def patch_event_loop(base_events: ModuleType) -> None:
    """Tell errors of tasks that nobody awaits."""
    from rclpy._patches.tracebacks import tell_caught

    module: Any = base_events
    loop = module.BaseEventLoop
    handle = loop.call_exception_handler

    def call_exception_handler(self: Any, context: dict[str, Any]) -> None:
        tell_caught(context.get("exception"))
        handle(self, context)

    loop.call_exception_handler = call_exception_handler


def patch_futures_thread(thread: ModuleType) -> None:
    """Renew the lock that guards the start and end of all pools, and tell errors that a future keeps."""
    from rclpy._patches.tracebacks import tell_caught

    module: Any = thread
    module._global_shutdown_lock = Lock()
    future = module._base.Future
    keep = future.set_exception

    def set_exception(self: Any, exception: BaseException | None) -> None:
        tell_caught(exception)
        keep(self, exception)

    future.set_exception = set_exception
