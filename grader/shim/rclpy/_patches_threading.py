"""What the modules built on `_thread` need beyond the replaced locks."""

from __future__ import annotations

import sys

from rclpy import _locks, _patches_thread
from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType
    from typing import Any


def patch_threading(threading: ModuleType) -> None:
    """Renew the module's own locks, give the main thread its virtual identifier, charge for questions."""
    module: Any = threading
    module.Lock = _locks.Lock
    module._allocate_lock = _locks.Lock
    module._CRLock = _locks.RLock
    module._active_limbo_lock = _locks.RLock()
    if hasattr(module, "_shutdown_locks_lock"):
        module._shutdown_locks_lock = _locks.Lock()
    main = module.main_thread()
    active = module._active
    active.pop(main._ident, None)
    main._ident = kernel.main.ident
    main._native_id = _patches_thread.get_native_id()
    active[main._ident] = main
    main._started._cond = module.Condition(_locks.Lock())
    if hasattr(main, "_tstate_lock"):
        main._tstate_lock = _locks.Lock()
        main._tstate_lock.acquire()
    else:
        main._handle = _patches_thread.make_thread_handle(main._ident)
    module.Event.is_set = _charged(module.Event.is_set)
    module.Event.isSet = module.Event.is_set
    module.Thread.is_alive = _charged(module.Thread.is_alive)
    module.excepthook = module.__excepthook__ = excepthook


def end_main_thread(threading: ModuleType) -> None:
    """Let those who join the main thread go on: the script's last line has run."""
    module: Any = threading
    main = module.main_thread()
    if hasattr(main, "_tstate_lock"):
        if main._tstate_lock is not None:
            main._tstate_lock.release()
            main._stop()
    else:
        main._handle._set_done()


def _charged(question: Callable[[Any], bool]) -> Callable[[Any], bool]:
    def ask(self: Any) -> bool:
        kernel.charge()
        return question(self)

    ask.__name__ = question.__name__
    ask.__qualname__ = question.__qualname__
    ask.__doc__ = question.__doc__
    return ask


def excepthook(args: Any, /) -> None:
    """Report the exception that ended a thread, as `threading.excepthook` does."""
    from rclpy import _report
    from rclpy._link import link

    if args.exc_type is SystemExit:
        return
    name = args.thread.name if args.thread is not None else str(_patches_thread.get_ident())
    error = args.exc_value if args.exc_value is not None else args.exc_type()
    print(f"Exception in thread {name}:", file=sys.stderr)  # noqa: T201
    _report.print_exception(error)
    place = _report.line_of(error)
    link.note("thread_exception", f"{name}, line {place}: {_report.one_line(error)}")


def patch_queue(queue: ModuleType) -> None:
    """Take the Python version of SimpleQueue, which is built from the replaced locks."""
    module: Any = queue
    module.SimpleQueue = module._PySimpleQueue
    native: Any = sys.modules.get("_queue")
    if native is not None:
        native.SimpleQueue = module._PySimpleQueue


def patch_logging(logging: ModuleType) -> None:
    """Renew the locks of the module and of its handlers."""
    module: Any = logging
    module._lock = _locks.RLock()
    for reference in module._handlerList:
        handler = reference()
        if handler is not None:
            handler.createLock()


def patch_futures_thread(thread: ModuleType) -> None:
    """Renew the lock that guards the start and end of all pools."""
    module: Any = thread
    module._global_shutdown_lock = _locks.Lock()
