"""Executors can be used by ``with``, do not wait at shutdown, and pass message infos on."""

from __future__ import annotations

from rclpy import executors
from rclpy._jazzy.overlay import extends
from rclpy._rcl.errors import InvalidHandle
from rclpy._rcl.watch import SUBSCRIPTION

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.task import Future

    Handler = Callable[[Any, Any], Coroutine[Any, Any, None]]

_GONE = object()
"""Stands for what an entity had when it was destroyed before its turn came."""

_humble_means = executors.Executor._means
_humble_handler_of = executors.SingleThreadedExecutor._handler_of
_humble_pool_init = executors.MultiThreadedExecutor.__init__
_ALONE = "MultiThreadedExecutor is used with a single thread.\nUse the SingleThreadedExecutor instead."


def _or_gone(take: Callable[[Any], Any], execute: Handler) -> tuple[Callable[[Any], Any], Handler]:
    def take_if_there(entity: Any) -> Any:
        try:
            return take(entity)
        except InvalidHandle:
            return _GONE

    async def execute_if_there(entity: Any, taken: Any) -> None:
        if taken is not _GONE:
            await execute(entity, taken)

    return take_if_there, execute_if_there


@extends(executors.Executor)
class Executor(executors.Executor):
    """Base of the executors."""

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop; callbacks that run are not waited for, whatever the timeout."""
        if not self._is_shutdown:
            self._is_shutdown = True
            self.wake()
        self._forget()
        return True

    def _take_subscription(self, sub: Any) -> Any:
        sub.handle.require()
        taken = sub.handle.take_message(sub.msg_type, sub.raw)
        if taken is None or sub._callback_type is sub.CallbackType.WithMessageInfo:
            return taken
        return taken[0]

    async def _execute_subscription(self, sub: Any, msg: Any) -> None:
        if type(msg) is tuple:
            await executors.await_or_execute(sub.callback, *msg)
        elif msg:
            await executors.await_or_execute(sub.callback, msg)

    def _means(self, kind: int) -> tuple[Callable[[Any], Any], Handler]:
        return _or_gone(*_humble_means(self, kind))


def spin_once_until_future_complete(
    self: Any, future: Future, timeout_sec: float | executors.TimeoutObject | None = None
) -> None:
    """Wait for one callback, which is run or handed to a thread, or for the future."""
    future.add_done_callback(lambda _: self.wake())
    self._spin_once_impl(timeout_sec, future.done)


@extends(executors.SingleThreadedExecutor)
class SingleThreadedExecutor(executors.SingleThreadedExecutor):
    """Runs callbacks in the thread that spins."""

    def _handler_of(self, kind: int, entity: Any, node: Node) -> Any:
        if kind == SUBSCRIPTION and entity._callback_type is entity.CallbackType.WithMessageInfo:
            return executors.Executor._handler_of(self, kind, entity, node)
        return _humble_handler_of(self, kind, entity, node)

    def _spin_once_impl(
        self,
        timeout_sec: float | executors.TimeoutObject | None = None,
        wait_condition: Callable[[], bool] = executors._never,
    ) -> None:
        try:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
        except (
            executors.ShutdownException,
            executors.TimeoutException,
            executors.ConditionReachedException,
        ):
            return
        executors._run(handler)

    spin_once_until_future_complete = spin_once_until_future_complete


@extends(executors.MultiThreadedExecutor)
class MultiThreadedExecutor(executors.MultiThreadedExecutor):
    """Runs callbacks in a pool of threads; they take turns deterministically."""

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        _humble_pool_init(self, num_threads, context=context)
        if num_threads == 1:
            import warnings

            warnings.warn(_ALONE, stacklevel=2)

    spin_once_until_future_complete = spin_once_until_future_complete
