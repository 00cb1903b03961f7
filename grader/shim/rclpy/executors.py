"""Executors: wait for timers, messages, requests and triggers of nodes, and run their callbacks."""

from __future__ import annotations

from collections import deque

from rclpy import _distro
from rclpy._forwarding import passed_on
from rclpy._kernel import kernel, skip_to_pose
from rclpy._link import link
from rclpy._rcl.errors import GUARD_CONTEXT, WAIT_CONTEXT, RCLError
from rclpy._rcl.handles import changes
from rclpy._rcl.watch import CLIENT, GUARD, SERVICE, SUBSCRIPTION, TIMER, Watch
from rclpy.exceptions import InvalidHandle as InvalidHandle
from rclpy.guard_condition import GuardCondition
from rclpy.task import Future, Task, is_coroutine_function
from rclpy.task import await_or_execute as await_or_execute
from rclpy.utilities import get_default_context, timeout_sec_to_nsec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Generator, Sequence
    from typing import Any

    from rclpy._rcl.handles import ContextHandle
    from rclpy._rcl.watch import Place
    from rclpy.context import Context
    from rclpy.node import Node

    Ready = tuple[Task | "_Call", Any, Node]

__getattr__ = passed_on(__name__)

_MOST_WATCHES = 16
"""How many watches are kept for waits during which callbacks run: few scripts have more combinations of these."""

CPU_COUNT = 4
"""Threads of a MultiThreadedExecutor that is not told a number: the same on every grading host."""


def _never() -> bool:
    return False


def _members_of(node: Node) -> tuple[Any, ...]:
    """Return what a node consists of: iterators, unless `node` is a class or has methods of these names."""
    return node.subscriptions, node.timers, node.clients, node.services, node.guards, node.waitables


def _is_over(deadline_ns: int | None, ended_ns: int, yielded: bool) -> bool:
    """Whether a wait that ended at `ended_ns` has timed out.

    What is ready at the very instant comes first: upstream makes the timer of the timeout last.
    """
    return deadline_ns is not None and (ended_ns > deadline_ns or (ended_ns == deadline_ns and not yielded))


def _is_done(future: Any) -> bool:
    """Ask a future, which may be somebody else's; asking ours costs no time here."""
    return bool(future._done if isinstance(future, Future) else future.done())


class TimeoutException(Exception):
    """A wait timed out."""


class ShutdownException(Exception):
    """The executor was shut down."""


class ExternalShutdownException(Exception):
    """The context was shut down from elsewhere."""


class ConditionReachedException(Exception):
    """The future waited for is done."""


class TimeoutObject:
    """A timeout that its owner updates between waits."""

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout

    @property
    def timeout(self) -> float:
        return self._timeout

    @timeout.setter
    def timeout(self, timeout: float) -> None:
        self._timeout = timeout


class _WaitedIn:
    """Stands for a generator of `_wait_for_ready_callbacks` that a thread waits in, where there is none."""

    def __next__(self) -> Ready:
        raise ValueError("generator already executing")


_WAITED_IN = _WaitedIn()
_NO_TIMEOUT: dict[str, Any] = {"timeout_sec": None}


class _Spinning:
    """While inside, an executor waits for ever by nature: an idle node is no deadlock."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def __enter__(self) -> None:
        self._executor._spinning += 1

    def __exit__(self, *_: object) -> None:
        self._executor._spinning -= 1


class _WorkTracker:
    """Which threads have begun callbacks that have not ended."""

    def __init__(self) -> None:
        self.running: list[object] = []

    def wait(self, timeout_sec: float | None = None) -> bool:
        """Block until no other thread runs one; False when the timeout (None or negative: never) came first.

        The caller's own callback does not count, as on Jazzy. Humble waits for it, too, and so for ever
        (ros2/rclpy#944, #1646); the student is told.
        """
        me = kernel.running

        def idle() -> bool:
            return all(thread is me for thread in self.running)

        if idle():
            if self.running and _distro.chosen == _distro.HUMBLE and (timeout_sec is None or timeout_sec < 0):
                _tell_that_humble_hangs()
            return True
        deadline_ns = None
        if timeout_sec is not None and timeout_sec >= 0:
            deadline_ns = kernel.now_ns + timeout_sec_to_nsec(timeout_sec)
        return kernel.wait(idle, deadline_ns, "executor.shutdown() waits for callbacks to end")


def _tell_that_humble_hangs() -> None:
    """Note the line that calls shutdown(), the first time: at home nothing comes after it.

    There is none where `shutdown` itself is the callback.
    """
    from rclpy._patches.tracebacks import line_of_call

    here = _tell_that_humble_hangs.__code__
    line = line_of_call(here.co_filename, (here.co_name, "wait", "shutdown"))
    if line:
        link.note_once("shutdown_in_callback", str(line))


class Executor:
    """Base of the executors; a custom one defines `spin_once`, using `wait_for_ready_callbacks`."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__()
        self._context = get_default_context() if context is None else context
        self._tasks: list[tuple[Task, Any, Node | None]] = []
        self._work_tracker = _WorkTracker()
        self._nodes: dict[Node, None] = {}
        self._guard: GuardCondition | None = GuardCondition(
            callback=None, callback_group=None, context=self._context
        )
        self._woken = self._guard.handle.backlog  # true while the guard condition is triggered
        self._is_shutdown = False
        self._cb_iter: Generator[Ready, None, None] | _WaitedIn | None = None
        self._last_args: Any = None
        self._last_kwargs: Any = None
        self._spinning = 0
        self._watch: Watch | None = None
        # those of waits while callbacks run, by `Changes.given_out`
        self._busy_watches: dict[tuple[tuple[int, bool], ...], Watch] = {}
        self._sigint_gc = None
        self._context.on_shutdown(self.wake)

    def __del__(self) -> None:
        """Upstream destroys its guard condition: it fails where there is none, as `__init__` has failed."""
        _ = self._sigint_gc

    @property
    def context(self) -> Context:
        return self._context

    def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Task:
        """Have a function or coroutine function run by this executor; the task is also its future."""
        task = Task(callback, args, kwargs, executor=self)
        self._tasks.append((task, None, None))
        self._trigger()
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop, waiting for running callbacks; False when the timeout (None or negative: never) came first."""
        if not self._is_shutdown:
            self._is_shutdown = True
            self.wake()
        if not self._work_tracker.wait(timeout_sec):
            return False
        self._forget()
        return True

    def _forget(self) -> None:
        self._nodes = {}
        self._busy_watches.clear()
        if self._guard is not None:
            self._guard.destroy()
            self._guard = None
        self._cb_iter = None
        self._last_args = None
        self._last_kwargs = None

    def add_node(self, node: Node) -> bool:
        """Serve a node from now on; False when it is served already."""
        if node in self._nodes:
            return False
        self._nodes = {**self._nodes, node: None}
        node.executor = self
        self._trigger()
        return True

    def remove_node(self, node: Node) -> None:
        """Stop serving a node."""
        if node in self._nodes:
            nodes = dict(self._nodes)
            del nodes[node]
            self._nodes = nodes
            self._busy_watches.clear()  # they would keep it alive
            self._trigger()

    def wake(self) -> None:
        """Have a blocked wait look again."""
        if self._guard is not None and not self._woken:
            self._woken.append(True)

    def _trigger(self) -> None:
        """Do the same where upstream does not ask whether the executor was shut down.

        Raises AttributeError: it was.
        """
        if self._guard is None:
            raise AttributeError("'NoneType' object has no attribute 'trigger'")
        self.wake()

    def get_nodes(self) -> list[Node]:
        """Return the nodes served, in the order they were added."""
        return list(self._nodes)

    def spin(self) -> None:
        """Run callbacks until shutdown."""
        with _Spinning(self):
            while self._context._valid() and not self._is_shutdown:
                self.spin_once()
                self._spin_on()

    def _spin_while_valid(self) -> None:
        """Run callbacks until the context is shut down: what `rclpy.spin` does."""
        with _Spinning(self):
            while self._context._valid():
                self.spin_once()
                self._spin_on()

    def _spin_on(self) -> None:
        """Do what further calls of `spin_once` would, if the executor can do it faster."""

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
        waited: tuple[Watch, int | None] | None = None,
    ) -> Generator[Ready, None, None]:
        """Yield what is ready after one wait: unfinished tasks first, then what `Watch.served` says.

        Or after a wait that is over: `waited`, with its deadline.

        Raises:
            TimeoutException: nothing (more) came in time. ShutdownException: the executor was shut down.
            ExternalShutdownException: the context was. ConditionReachedException: `condition` holds.
        """
        deadline_ns = self._deadline_of(timeout_sec) if waited is None else waited[1]
        yielded = False
        while not yielded and not self._is_shutdown and not condition():
            if waited is None:
                self._woken.clear()
                using = self.get_nodes() if nodes is None else nodes
                for task, entity, node in reversed(tuple(self._tasks)) if self._tasks else ():
                    if not task.executing() and not task._done and (node is None or node in using):
                        yielded = True
                        yield task, entity, node
                watch = self._wait_once(using, deadline_ns)
            else:
                watch, waited = waited[0], None
            ended_ns = watch.ended_ns
            for kind, entity, node in watch.served():
                yielded = True
                yield self._handler_of(kind, entity, node), entity, node
            self._put_back(watch)
            if _is_over(deadline_ns, ended_ns, yielded):
                raise TimeoutException()
        if self._is_shutdown:
            raise ShutdownException()
        if condition():
            raise ConditionReachedException()

    def _wait_once(self, nodes: Sequence[Node], deadline_ns: int | None) -> Watch:
        """Block until the nodes have something ready, the executor is woken or the deadline has come."""
        self._tasks = [item for item in self._tasks if not (item[0]._done or item[0]._abandoned)]
        self._require_context(f"failed to initialize wait set: {WAIT_CONTEXT}")
        watch = self._take_watch(nodes)
        self._block(watch, deadline_ns)
        watch.settle()
        return watch

    def _take_watch(self, nodes: Sequence[Node]) -> Watch:
        """Return the watch of an earlier wait if it still holds. No other wait uses it until `_put_back`."""
        if changes.executing:
            watch = self._busy_watches.pop(changes.given_out(), None)
        else:
            watch, self._watch = self._watch, None
        if watch is not None:
            if watch.holds(self.can_execute, nodes):
                return watch
            self._busy_watches.clear()  # what made this one stale made them stale as well
        for node in nodes:
            for members in _members_of(node):
                iter(members)
        return Watch(self.can_execute, nodes)

    def _put_back(self, watch: Watch) -> None:
        if not watch.lasting:
            return
        if not watch.given_out:
            self._watch = watch
            return
        if len(self._busy_watches) == _MOST_WATCHES:
            self._busy_watches.clear()
        self._busy_watches[watch.given_out] = watch

    def _deadline_of(self, timeout_sec: float | TimeoutObject | None) -> int | None:
        if timeout_sec is None:
            return None
        seconds = timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
        timeout_ns = timeout_sec_to_nsec(seconds)
        if timeout_ns > 0:  # upstream measures it by a timer, which it cannot create after shutdown
            self._require_context(f"failed to create timer: {GUARD_CONTEXT}")
        return None if timeout_ns < 0 else kernel.now_ns + timeout_ns

    def _require_context(self, failure: str) -> None:
        if not self._context._valid():
            raise RCLError(failure)

    def _block(self, watch: Watch, deadline_ns: int | None) -> None:
        """Block until the watch is ready, the executor is woken or the earliest deadline has come."""
        woken, context, watch_ready = self._woken, self._context.handle, watch.ready
        assert context is not None

        def ready() -> bool:
            return bool(woken) or self._is_shutdown or not context.valid or watch_ready()

        due_ns = watch.deadline_ns
        until_ns = (
            deadline_ns if due_ns is None or (deadline_ns is not None and deadline_ns < due_ns) else due_ns
        )
        kernel.wait(ready, until_ns, self._why(), idle=bool(self._spinning) or watch.open)
        watch.ended_ns = kernel.now_ns
        if watch.deadline_ns == kernel.now_ns:
            kernel.be_late(watch.late_ns)
        if self._is_shutdown:
            raise ShutdownException()
        if not context.valid:
            raise ExternalShutdownException()

    def _why(self) -> str:
        if self._spinning:
            return "spin()"
        return "spin_once() waits for a timer, a message or a request, but nothing of that can come"

    def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Ready:
        """Return the next ready task with its entity and node; see `_wait_for_ready_callbacks`."""
        while True:
            ready = self._left_of_last_wait(args, kwargs)
            if ready is not None:
                return ready
            self._last_args = args
            self._last_kwargs = kwargs
            self._cb_iter = self._wait_for_ready_callbacks(*args, **kwargs)

    def _left_of_last_wait(self, args: Any, kwargs: Any) -> Ready | None:
        """Return what else was ready at the last wait, if that had the same arguments."""
        if self._cb_iter is None or self._last_args != args or self._last_kwargs != kwargs:
            return None
        try:
            return next(self._cb_iter)
        except StopIteration:
            self._cb_iter = None
            return None

    # What is done with something that is ready: take what it has, run its callback in a task ---------

    def _take_timer(self, tmr: Any) -> None:
        tmr.handle.require()
        tmr.handle.call_timer()

    async def _execute_timer(self, tmr: Any, _: Any) -> None:
        await await_or_execute(tmr.callback)

    def _take_subscription(self, sub: Any) -> Any:
        handle = sub.handle
        handle.require()
        return handle.take(sub.msg_type, sub.raw)

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

    def _handler_of(self, kind: int, entity: Any, node: Node) -> Task | _Call:
        return self._make_handler(entity, node, *self._means(kind))

    def _make_handler(
        self,
        entity: Any,
        node: Node,
        take_from_wait_list: Callable[[Any], Any],
        call_coroutine: Callable[[Any, Any], Coroutine[Any, Any, None]],
    ) -> Task:
        """Return the task that takes what an entity has and runs its callback, by its group's rules."""
        entity._executor_event = True
        changes.executing.append(entity)
        kernel.steps += 1

        async def handler(entity: Any, is_shutdown: bool) -> None:
            if is_shutdown or not entity.callback_group.beginning_execution(entity):
                entity._executor_event = False
                changes.executing.remove(entity)
                self.wake()
                return
            running, begun_by = self._work_tracker.running, kernel.running
            running.append(begun_by)
            try:
                taken = take_from_wait_list(entity)
                entity._executor_event = False
                self.wake()
                try:
                    await call_coroutine(entity, taken)
                finally:
                    entity.callback_group.ending_execution(entity)
                    changes.executing.remove(entity)
                    self.wake()
            finally:
                running.remove(begun_by)  # what has awaited may end in another thread

        task = Task(handler, (entity, self._is_shutdown), executor=self)
        self._tasks.append((task, entity, node))
        return task


class _Call:
    """A callback that neither waits nor is waited for: what a task would do, without a coroutine for each."""

    __slots__ = ("_entity", "_executor", "_is_shutdown", "_kind")

    def __init__(self, executor: SingleThreadedExecutor, kind: int, entity: Any) -> None:
        entity._executor_event = True
        changes.executing.append(entity)
        kernel.steps += 1
        self._executor = executor
        self._kind = kind
        self._entity = entity
        self._is_shutdown = executor._is_shutdown

    def __call__(self) -> None:
        self._executor._execute(self._kind, self._entity, self._is_shutdown)

    def exception(self) -> None:
        """Return None: what the callback raised has come out of the call."""


class SingleThreadedExecutor(Executor):
    """Runs callbacks in the thread that spins."""

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)

    def _handler_of(self, kind: int, entity: Any, node: Node) -> Task | _Call:
        plain = kind in (TIMER, SUBSCRIPTION) and not is_coroutine_function(entity.callback)
        if plain and type(self) is SingleThreadedExecutor:  # it is called as soon as it is given out
            return _Call(self, kind, entity)
        return super()._handler_of(kind, entity, node)

    def _execute(self, kind: int, entity: Any, is_shutdown: bool = False) -> None:
        """Run the plain callback of a timer or subscription that has been given out."""
        group = entity.callback_group
        if is_shutdown or not group.beginning_execution(entity):
            entity._executor_event = False
            changes.executing.remove(entity)
            self.wake()
            return
        running = self._work_tracker.running
        running.append(kernel.running)
        try:
            message = None
            handle = entity.handle
            if handle.doomed:
                handle.require()
            if kind == TIMER:
                handle.call_timer()
            else:
                message = handle.take(entity.msg_type, entity.raw)
            entity._executor_event = False
            if not self._woken:
                self.wake()
            try:
                if kind == TIMER:
                    entity.callback()
                elif message:
                    entity.callback(message)
            except StopIteration as error:
                raise RuntimeError("coroutine raised StopIteration") from error  # as in a task
            finally:
                group.ending_execution(entity)
                changes.executing.remove(entity)
                if not self._woken:
                    self.wake()
        finally:
            running.remove(kernel.running)

    def _wait_for_lone_callback(self, timeout_sec: float | TimeoutObject | None) -> Place | None:
        """Wait for the next callback and give it out, if it is a plain one and the only one that is ready.

        `wait_for_ready_callbacks` comes to the same and takes three times as long. If the wait finds anything
        else, that one returns it next.

        Raises TimeoutException: nothing came in time.
        """
        if self._cb_iter is not None or self._tasks or self._is_shutdown or not self._context._valid():
            return None
        deadline_ns = None if timeout_sec is None else self._deadline_of(timeout_sec)
        watch = self._take_watch(self.get_nodes())
        asked_with = _NO_TIMEOUT if timeout_sec is None else {"timeout_sec": timeout_sec}
        place = self._next_lone(watch, deadline_ns, asked_with)
        if place is None:
            if watch.idle and deadline_ns is not None and kernel.now_ns >= deadline_ns:
                self._put_back(watch)
                raise TimeoutException
            self._last_args, self._last_kwargs = (), asked_with
            self._cb_iter = self._wait_for_ready_callbacks(timeout_sec, waited=(watch, deadline_ns))
        else:
            self._put_back(watch)
        return place

    def _spin_on(self) -> None:
        """Run callbacks one by one; return as soon as anything but messages and timers has to be looked at."""
        context = self._context.handle
        if context is None or type(self) is not SingleThreadedExecutor:
            return
        self._run_left(context)
        watch, nodes = self._watch, self._nodes
        if watch is None or not watch.holds(self.can_execute, list(nodes)):
            return
        while True:
            # not as the loop's condition: Python 3.11 specialises no loop whose end jumps back on a condition
            if (
                self._watch is not watch
                or self._nodes is not nodes
                or self._cb_iter is not None
                or self._tasks
                or self._is_shutdown
                or changes.executing
                or not context.valid
                or not watch.unchanged()
            ):
                return
            self._watch = None
            try:
                place = self._next_lone(watch, None, _NO_TIMEOUT)
            except ShutdownException:
                return
            if place is None:
                self._last_args, self._last_kwargs = (), _NO_TIMEOUT
                self._cb_iter = self._wait_for_ready_callbacks(waited=(watch, None))
                self._run_left(context)
            else:
                self._watch = watch
                self._execute(place[1], place[3])

    def _run_left(self, context: ContextHandle) -> None:
        """Run what else the last wait has found, if that was a wait without a timeout."""
        left = self._cb_iter
        if left is None or self._last_args != () or self._last_kwargs != _NO_TIMEOUT:
            return
        while self._cb_iter is left and context.valid and not self._is_shutdown:
            try:
                handler, _, _ = next(left)
            except StopIteration:
                self._cb_iter = None
                return
            except (ShutdownException, TimeoutException):
                return
            _run(handler)

    def _next_lone(self, watch: Watch, deadline_ns: int | None, asked_with: dict[str, Any]) -> Place | None:
        """Block until something is ready; give it out, if it is the only one, plain and in time.

        None: `watch` is settled, and the caller serves what it holds.

        A thread that waits with the same arguments (`asked_with`) meanwhile gets upstream's ValueError.
        """
        self._last_args, self._last_kwargs = (), asked_with
        self._cb_iter = _WAITED_IN
        self._woken.clear()
        settled = False
        try:
            place = None if watch.deadline_ns is None else watch.lone_timer()
            if place is None or not self._skip_to_tick(watch, deadline_ns):
                heard = self._skip_to_pose(watch, deadline_ns)
                place = watch.lone_message(heard) if heard else None
                if place is None:
                    if not heard or not watch.ready():
                        self._block(watch, deadline_ns)
                    watch.settle()
                    settled = True
                    place = watch.lone()
        finally:
            if self._cb_iter is _WAITED_IN:
                self._cb_iter = None
        in_time = deadline_ns is None or watch.ended_ns <= deadline_ns
        if place is None or not in_time or not watch.is_plain(place[3].callback):
            if not settled:
                watch.settle()
            return None
        entity = place[3]
        entity._executor_event = True
        changes.executing.append(entity)
        kernel.steps += 1
        return place

    def _skip_to_tick(self, watch: Watch, deadline_ns: int | None) -> bool:
        """Wait for the next timer; False, and nothing was done, if anything else can happen until then."""
        due_ns, late_ns = watch.deadline_ns, watch.late_ns
        assert due_ns is not None
        watch.ended_ns = due_ns
        return (deadline_ns is None or due_ns <= deadline_ns) and kernel.skip_to_tick(due_ns, late_ns)

    def _skip_to_pose(self, watch: Watch, deadline_ns: int | None) -> tuple[int, ...]:
        """Wait for the next pose; return who got it. Nobody: nothing was done, as anything else comes first."""
        due_ns = kernel.horizon_ns if watch.deadline_ns is None else watch.deadline_ns
        if deadline_ns is not None and deadline_ns < due_ns:
            due_ns = deadline_ns
            if due_ns <= kernel.now_ns:
                return ()
        heard = skip_to_pose(watch.ready, due_ns)
        watch.ended_ns = kernel.now_ns
        return heard

    def _spin_once_impl(self, timeout_sec: float | TimeoutObject | None = None) -> None:
        handler: Task | _Call | None = None
        try:
            ready = None
            if self._cb_iter is not None:
                ready = self._left_of_last_wait((), {"timeout_sec": timeout_sec})
            place = None
            if ready is None and type(self) is SingleThreadedExecutor:
                place = self._wait_for_lone_callback(timeout_sec)
            if place is None:
                handler, _, _ = ready or self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
        except (ShutdownException, TimeoutException):
            return
        if handler is None:
            assert place is not None
            self._execute(place[1], place[3])
            return
        _run(handler)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it."""
        self._spin_once_impl(timeout_sec)

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: float | TimeoutObject | None = None
    ) -> None:
        """Wait for one callback and run it."""
        self._spin_once_impl(timeout_sec)


def _run(handler: Task | _Call) -> None:
    """Run a callback in this thread; what it raises comes out."""
    handler()
    error = handler.exception()
    if error is not None:
        raise error


class WorkerPool:
    """Runs callables in up to `size` threads, started when they are needed.

    What a callable raises is lost, as in a thread pool nobody asks for results. The end of the program waits for
    what has been submitted, as it does for upstream's thread pool.
    """

    def __init__(self, size: int) -> None:
        if size <= 0:
            raise ValueError("max_workers must be greater than 0")
        self._max_workers = size
        self._work: deque[Callable[[], Any]] = deque()
        self._idle = 0
        self._started = 0
        self._busy = 0

    def submit(self, work: Callable[[], Any]) -> None:
        """Have `work` called in one of the threads."""
        self._work.append(work)
        if self._idle < len(self._work) and self._started < self._max_workers:
            self._start()

    def _start(self) -> None:
        import threading

        if not self._started:
            target: Any = threading
            target._register_atexit(self._finish)
        self._started += 1
        threading.Thread(
            target=self._run, name=f"ThreadPoolExecutor-0_{self._started - 1}", daemon=True
        ).start()

    def _run(self) -> None:
        while True:
            self._idle += 1
            kernel.wait(lambda: bool(self._work), None, "a worker of the executor", idle=True)
            self._idle -= 1
            if self._work:
                work = self._work.popleft()
                self._busy += 1
                try:
                    work()
                except BaseException:  # noqa: S110
                    pass
                finally:
                    self._busy -= 1

    def _finish(self) -> None:
        why = "the end of the program waits for callbacks of the executor's threads"
        kernel.wait(lambda: not self._busy and not self._work, None, why)


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
        assert isinstance(handler, Task)  # only a SingleThreadedExecutor makes other handlers
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
