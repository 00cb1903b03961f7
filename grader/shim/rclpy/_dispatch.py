"""What an executor does with something that is ready: take what it has, run its callback in a task."""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy._watch import CLIENT, GUARD, SERVICE, SUBSCRIPTION, TIMER
from rclpy.task import Task, is_coroutine_function
from rclpy.utilities import timeout_sec_to_nsec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from types import TracebackType
    from typing import Any

    from rclpy.node import Node


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a function, or await a coroutine function."""
    if is_coroutine_function(callback):
        return await callback(*args)
    return callback(*args)


class _WorkTracker:
    """Which threads are running callbacks."""

    def __init__(self) -> None:
        self._running: list[object] = []

    def __enter__(self) -> None:
        self._running.append(kernel.running)

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        self._running.remove(kernel.running)

    def wait(self, timeout_sec: float | None = None) -> bool:
        """Block until no other thread runs one; False when the timeout (None or negative: never) came first.

        The caller's own callback does not count: `rclpy.shutdown()` in a callback ends the spin
        (ros2/rclpy#944, mended in Humble).
        """
        me = kernel.running

        def idle() -> bool:
            return all(thread is me for thread in self._running)

        if idle():
            return True
        deadline_ns = None
        if timeout_sec is not None and timeout_sec >= 0:
            deadline_ns = kernel.now_ns + timeout_sec_to_nsec(timeout_sec)
        return kernel.wait(idle, deadline_ns, "executor.shutdown() waits for callbacks to end")


class Dispatcher:
    """Makes tasks of ready entities."""

    def __init__(self) -> None:
        super().__init__()
        self._tasks: list[tuple[Task, Any, Node | None]] = []
        self._is_shutdown = False
        self._work_tracker = _WorkTracker()

    def wake(self) -> None:
        """Have a blocked wait look again."""
        raise NotImplementedError()

    def _take_timer(self, tmr: Any) -> None:
        tmr.handle.require()
        tmr.handle.call_timer()

    async def _execute_timer(self, tmr: Any, _: Any) -> None:
        await await_or_execute(tmr.callback)

    def _take_subscription(self, sub: Any) -> Any:
        sub.handle.require()
        taken = sub.handle.take_message(sub.msg_type, sub.raw)
        return None if taken is None else taken[0]

    async def _execute_subscription(self, sub: Any, msg: Any) -> None:
        if msg:
            await await_or_execute(sub.callback, msg)

    def _take_client(self, client: Any) -> Any:
        client.handle.require()
        return client.handle.take_response(client.srv_type.Response)

    async def _execute_client(self, client: Any, seq_and_response: Any) -> None:
        header, response = seq_and_response
        if header is None:
            return
        try:
            future = client.get_pending_request(header.request_id.sequence_number)
        except KeyError:
            return  # the request was cancelled
        future._set_executor(self)
        future.set_result(response)

    def _take_service(self, srv: Any) -> Any:
        srv.handle.require()
        return srv.handle.service_take_request(srv.srv_type.Request)

    async def _execute_service(self, srv: Any, request_and_header: Any) -> None:
        if request_and_header is None:
            return
        request, header = request_and_header
        if request:
            response = await await_or_execute(srv.callback, request, srv.srv_type.Response())
            srv.send_response(response, header)

    def _take_guard_condition(self, gc: Any) -> None:
        gc._executor_triggered = False

    async def _execute_guard_condition(self, gc: Any, _: Any) -> None:
        await await_or_execute(gc.callback)

    async def _execute_waitable(self, waitable: Any, data: Any) -> None:
        for future in waitable._futures:
            future._set_executor(self)
        await waitable.execute(data)

    def _means(
        self, kind: int
    ) -> tuple[Callable[[Any], Any], Callable[[Any, Any], Coroutine[Any, Any, None]]]:
        if kind == TIMER:
            return self._take_timer, self._execute_timer
        if kind == SUBSCRIPTION:
            return self._take_subscription, self._execute_subscription
        if kind == GUARD:
            return self._take_guard_condition, self._execute_guard_condition
        if kind == CLIENT:
            return self._take_client, self._execute_client
        if kind == SERVICE:
            return self._take_service, self._execute_service
        return (lambda waitable: waitable.take_data()), self._execute_waitable

    def _make_handler(
        self,
        entity: Any,
        node: Node,
        take_from_wait_list: Callable[[Any], Any],
        call_coroutine: Callable[[Any, Any], Coroutine[Any, Any, None]],
    ) -> Task:
        """Return the task that takes what an entity has and runs its callback, by its group's rules."""
        entity._executor_event = True

        async def handler(entity: Any, is_shutdown: bool) -> None:
            if is_shutdown or not entity.callback_group.beginning_execution(entity):
                entity._executor_event = False
                self.wake()
                return
            with self._work_tracker:
                taken = take_from_wait_list(entity)
                entity._executor_event = False
                self.wake()
                try:
                    await call_coroutine(entity, taken)
                finally:
                    entity.callback_group.ending_execution(entity)
                    self.wake()

        task = Task(handler, (entity, self._is_shutdown), executor=self)  # type: ignore[arg-type]
        self._tasks.append((task, entity, node))
        return task
