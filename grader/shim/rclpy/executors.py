"""Executors: wait for timers, messages, requests and triggers of nodes, and run their callbacks."""

from __future__ import annotations

from rclpy._dispatch import Dispatcher
from rclpy._dispatch import await_or_execute as await_or_execute
from rclpy._executor_states import (
    ConditionReachedException,
    ExternalShutdownException,
    ShutdownException,
    Spinning,
    TimeoutException,
    TimeoutObject,
)
from rclpy._kernel import kernel
from rclpy._watch import Watch
from rclpy._workers import WorkerPool
from rclpy.exceptions import InvalidHandle as InvalidHandle
from rclpy.guard_condition import GuardCondition
from rclpy.task import Future, Task
from rclpy.utilities import get_default_context, timeout_sec_to_nsec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from typing import Any

    from rclpy.context import Context
    from rclpy.node import Node

    Ready = tuple[Task, Any, Node]

MAX_LATENESS_NS = 5_000_000
"""Latest that a timer is called after it is due while nothing else keeps the executor busy."""

CPU_COUNT = 4
"""Threads of a MultiThreadedExecutor that is not told a number: the same on every grading host."""


def _never() -> bool:
    return False


def _is_done(future: Any) -> bool:
    """Ask a future, which may be somebody else's; asking ours costs no time here."""
    return bool(future._done if isinstance(future, Future) else future.done())


class Executor(Dispatcher):
    """Base of the executors; a custom one defines `spin_once`, using `wait_for_ready_callbacks`."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__()
        self._context = get_default_context() if context is None else context
        self._nodes: dict[Node, None] = {}
        self._guard: GuardCondition | None = GuardCondition(
            callback=None, callback_group=None, context=self._context
        )
        self._is_shutdown = False
        self._cb_iter: Generator[Ready, None, None] | None = None
        self._last_args: Any = None
        self._last_kwargs: Any = None
        self._spinning = 0
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Context:
        return self._context

    def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Task:
        """Have a function or coroutine function run by this executor; the task is also its future."""
        task = Task(callback, args, kwargs, executor=self)
        self._tasks.append((task, None, None))
        self.wake()
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop, waiting for running callbacks; False when the timeout (None or negative: never) came first."""
        if not self._is_shutdown:
            self._is_shutdown = True
            self.wake()
        if not self._work_tracker.wait(timeout_sec):
            return False
        self._nodes = {}
        if self._guard is not None:
            self._guard.destroy()
            self._guard = None
        self._cb_iter = None
        self._last_args = None
        self._last_kwargs = None
        return True

    def add_node(self, node: Node) -> bool:
        """Serve a node from now on; False when it is served already."""
        if node in self._nodes:
            return False
        self._nodes[node] = None
        node.executor = self
        iter(node.subscriptions)  # of a class instead of a node it is a property, as the first wait finds
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        """Stop serving a node."""
        if node in self._nodes:
            del self._nodes[node]
            self.wake()

    def wake(self) -> None:
        """Have a blocked wait look again."""
        if self._guard is not None:
            self._guard.trigger()

    def get_nodes(self) -> list[Node]:
        """Return the nodes served, in the order they were added."""
        return list(self._nodes)

    def spin(self) -> None:
        """Run callbacks until shutdown."""
        with Spinning(self):
            while self._context._valid() and not self._is_shutdown:
                self.spin_once()

    def _spin_while_valid(self) -> None:
        """Run callbacks until the context is shut down: what `rclpy.spin` does."""
        with Spinning(self):
            while self._context._valid():
                self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until the future is done or the timeout (None or negative: never) has passed."""
        future.add_done_callback(lambda _: self.wake())
        if timeout_sec is None or timeout_sec < 0:
            while self._context._valid() and not _is_done(future) and not self._is_shutdown:
                self.spin_once_until_future_complete(future, timeout_sec)
            return
        end_ns = kernel.now_ns + timeout_sec_to_nsec(timeout_sec)
        left = TimeoutObject(timeout_sec)
        while self._context._valid() and not _is_done(future) and not self._is_shutdown:
            self.spin_once_until_future_complete(future, left)
            if kernel.now_ns >= end_ns:
                return
            left.timeout = (end_ns - kernel.now_ns) / 1e9

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it; the timeout None or negative blocks, 0 does not."""
        raise NotImplementedError()

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: float | TimeoutObject | None = None
    ) -> None:
        """As `spin_once`, and end as soon as the future is done."""
        raise NotImplementedError()

    # Waiting -------------------------------------------------------------------------------------

    def can_execute(self, entity: Any) -> bool:
        """Whether a callback of the entity may be given out."""
        return not entity._executor_event and entity.callback_group.can_execute(entity)

    def _wait_for_ready_callbacks(
        self,
        timeout_sec: float | TimeoutObject | None = None,
        nodes: Sequence[Node] | None = None,
        condition: Callable[[], bool] = _never,
    ) -> Generator[Ready, None, None]:
        """Yield what is ready after one wait: unfinished tasks first, then what `Watch.served` says.

        Raises:
            TimeoutException: nothing (more) came in time. ShutdownException: the executor was shut down.
            ExternalShutdownException: the context was. ConditionReachedException: `condition` holds.
        """
        seconds = timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
        timeout_ns = timeout_sec_to_nsec(seconds)
        deadline_ns = None if timeout_ns < 0 else kernel.now_ns + timeout_ns
        yielded = False
        while not yielded and not self._is_shutdown and not condition():
            guard = self._guard.handle.backlog if self._guard is not None else []
            guard.clear()
            using = self.get_nodes() if nodes is None else nodes
            for task, entity, node in reversed(tuple(self._tasks)):
                if not task.executing() and not task._done and (node is None or node in using):
                    yielded = True
                    yield task, entity, node
            self._tasks = [item for item in self._tasks if not item[0]._done]
            watch = Watch(self, using)
            self._block(watch, guard, deadline_ns)
            timed_out = deadline_ns is not None and kernel.now_ns >= deadline_ns
            watch.settle()
            for kind, entity, node in watch.served():
                yielded = True
                yield self._make_handler(entity, node, *self._means(kind)), entity, node
            if timed_out:
                raise TimeoutException()
        if self._is_shutdown:
            raise ShutdownException()
        if condition():
            raise ConditionReachedException()

    def _block(self, watch: Watch, guard: list[bool], deadline_ns: int | None) -> None:
        """Block until the watch is ready, the executor is woken or the earliest deadline has come."""
        context = self._context

        def ready() -> bool:
            return bool(guard) or self._is_shutdown or not context._valid() or watch.ready()

        deadlines = [at for at in (watch.deadline_ns, deadline_ns) if at is not None]
        kernel.wait(ready, min(deadlines, default=None), self._why(), idle=bool(self._spinning) or watch.open)
        if watch.deadline_ns == kernel.now_ns:
            kernel.be_late(min(watch.period_ns // 5, MAX_LATENESS_NS))
        if self._is_shutdown:
            raise ShutdownException()
        if not context._valid():
            raise ExternalShutdownException()

    def _why(self) -> str:
        if self._spinning:
            return "spin()"
        return "spin_once() waits for a timer, a message or a request, but nothing of that can come"

    def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Ready:
        """Return the next ready task with its entity and node; see `_wait_for_ready_callbacks`."""
        while True:
            if self._cb_iter is None or self._last_args != args or self._last_kwargs != kwargs:
                self._last_args = args
                self._last_kwargs = kwargs
                self._cb_iter = self._wait_for_ready_callbacks(*args, **kwargs)
            try:
                return next(self._cb_iter)
            except StopIteration:
                self._cb_iter = None


class SingleThreadedExecutor(Executor):
    """Runs callbacks in the thread that spins."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)

    def _spin_once_impl(self, timeout_sec: float | TimeoutObject | None = None) -> None:
        try:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
        except (ShutdownException, TimeoutException):
            return
        handler()
        error = handler.exception()
        if error is not None:
            raise error

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it."""
        self._spin_once_impl(timeout_sec)

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: float | TimeoutObject | None = None
    ) -> None:
        """Wait for one callback and run it."""
        self._spin_once_impl(timeout_sec)


class MultiThreadedExecutor(Executor):
    """Runs callbacks in a pool of threads; they take turns deterministically."""

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._futures: list[Task] = []
        self._executor = WorkerPool(CPU_COUNT if num_threads is None else num_threads)

    def _spin_once_impl(
        self,
        timeout_sec: float | TimeoutObject | None = None,
        wait_condition: Callable[[], bool] = _never,
    ) -> None:
        try:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
        except (
            ExternalShutdownException,
            ShutdownException,
            TimeoutException,
            ConditionReachedException,
        ):
            return
        self._executor.submit(handler)
        self._futures.append(handler)
        for future in self._futures:
            if future._done:
                self._futures.remove(future)
                future.result()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and hand it to a thread."""
        self._spin_once_impl(timeout_sec)

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: float | TimeoutObject | None = None
    ) -> None:
        """Wait for one callback and hand it to a thread, or for the future."""
        self._spin_once_impl(timeout_sec, future.done)
