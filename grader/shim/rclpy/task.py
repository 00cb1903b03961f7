"""Futures, and tasks that executors run."""

from __future__ import annotations

import sys
from _weakref import ref

from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence
    from typing import Any, Protocol

    class Executor(Protocol):
        """What futures need of an executor; importing `rclpy.executors` for it would close a circle."""

        def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
            """Have a function or coroutine function run."""


_CO_COROUTINE = 0x80
"""``inspect.CO_COROUTINE``: importing inspect costs more than all of rclpy."""


def is_coroutine_function(callback: Any) -> bool:
    """Whether calling `callback` gives a coroutine: an ``async def`` function, method or partial of one."""
    if type(callback) is _METHOD:
        callback = callback.__func__
    if type(callback) is _FUNCTION:
        return bool(callback.__code__.co_flags & _CO_COROUTINE)
    while True:
        inner = getattr(callback, "__func__", None) or (
            getattr(callback, "func", None) if type(callback).__name__ == "partial" else None
        )
        if inner is None:
            break
        callback = inner
    code = getattr(callback, "__code__", None)
    return code is not None and bool(code.co_flags & _CO_COROUTINE)


_FUNCTION = type(is_coroutine_function)
_METHOD: Any = type(kernel.charge)


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a function, or await a coroutine function."""
    if is_coroutine_function(callback):
        return await callback(*args)
    return callback(*args)


_awaited = await_or_execute(print)
_COROUTINE: Any = type(_awaited)
_awaited.close()


def _no_executor() -> None:
    return None


def _in_event_loop() -> bool:
    """Whether asyncio runs this: its loop asks again and again, where an executor waits for a change."""
    native: Any = sys.modules.get("_asyncio")
    return native is not None and native._get_running_loop() is not None


class Future:
    """Outcome of something that is under way."""

    def __init__(self, *, executor: Executor | None = None) -> None:
        self._done = False
        self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None
        self._exception_fetched = False
        self._callbacks: list[Callable[[Future], Any]] = []
        self._executor: Callable[[], Executor | None] = _no_executor
        self._set_executor(executor)

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            print("The following exception was never retrieved: " + str(self._exception), file=sys.stderr)  # noqa: T201

    def __await__(self) -> Generator[None, None, Any]:
        polls = 0
        while not self._done:
            yield
            polls += 1
            if not self._done and _in_event_loop():
                kernel.poll(polls)
        return self.result()

    def cancel(self) -> None:
        """Request cancellation unless done."""
        if not self._done:
            self._cancelled = True
        self._schedule_or_invoke_done_callbacks()

    def cancelled(self) -> bool:
        """Whether cancellation was requested."""
        return self._cancelled

    def done(self) -> bool:
        """Whether there is a result or an exception; a loop that asks lets time pass."""
        if not self._done:
            kernel.charge()
        return self._done

    def result(self) -> Any:
        """Return the result (None while there is none) or raise the exception."""
        if self._exception:
            raise self.exception()  # type: ignore[misc]
        return self._result

    def exception(self) -> BaseException | None:
        """Return the exception, None when there is none."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: Any) -> None:
        """End with a result."""
        self._result = result
        self._done = True
        self._cancelled = False
        self._schedule_or_invoke_done_callbacks()

    def set_exception(self, exception: BaseException) -> None:
        """End with an exception."""
        self._exception = exception
        self._exception_fetched = False
        self._done = True
        self._cancelled = False
        self._schedule_or_invoke_done_callbacks()

    def _schedule_or_invoke_done_callbacks(self) -> None:
        executor = self._executor()
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            if executor is not None:
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            except Exception as error:
                import warnings

                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=2)

    def _set_executor(self, executor: Executor | None) -> None:
        self._executor = _no_executor if executor is None else ref(executor)

    def add_done_callback(self, callback: Callable[[Future], Any]) -> None:
        """Have `callback` called with this future when it is done; at once when it is done already."""
        if not self._done:
            self._callbacks.append(callback)
            return
        executor = self._executor()
        if executor is not None:
            executor.create_task(callback, self)
        else:
            callback(self)


class Task(Future):
    """A function or coroutine, run by calling the task; a coroutine that waits is resumed by the next call."""

    def __init__(
        self,
        handler: Callable[..., Any],
        args: Sequence[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        executor: Executor | None = None,
    ) -> None:
        super().__init__(executor=executor)
        self._handler: Any = handler
        self._args: Sequence[Any] | None = () if args is None else args
        self._kwargs: Mapping[str, Any] | None = {} if kwargs is None else kwargs
        self._coroutine = type(handler) is _COROUTINE  # asyncio's habit: an object instead of the function
        if is_coroutine_function(handler):
            self._coroutine = True
            self._handler = handler(*self._args, **self._kwargs)
            self._args = self._kwargs = None
        self._executing = False
        self._abandoned = False

    def __call__(self) -> None:
        """Run or resume; does nothing when done or running."""
        if self._done or self._executing:
            return
        self._executing = True
        try:
            if self._coroutine:
                self._resume()
            else:
                self._run()
        except BaseException:
            # SystemExit or KeyboardInterrupt out of a callback: the task counts as executing for ever, and whoever
            # spins again skips it (upstream's task.py:229-256 and executors.py:496).
            self._abandoned = True
            raise
        self._executing = False

    def _resume(self) -> None:
        try:
            self._handler.send(None)
        except StopIteration as stop:
            self._handler.close()
            self.set_result(stop.value)
            self._complete_task()
        except Exception as error:
            self.set_exception(error)
            self._complete_task()

    def _run(self) -> None:
        try:
            self.set_result(self._handler(*self._args, **self._kwargs))  # type: ignore[misc,arg-type]
        except Exception as error:
            self.set_exception(error)
        self._complete_task()

    def _complete_task(self) -> None:
        self._handler = None
        self._args = None
        self._kwargs = None

    def executing(self) -> bool:
        """Whether the task runs right now."""
        return self._executing
