"""One wait of an executor: which entities count, until when to block, and in which order they are served."""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy._rcl.wait_set import WaitSet

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Any

    from rclpy.node import Node

TIMER, SUBSCRIPTION, GUARD, CLIENT, SERVICE, WAITABLE = range(6)


class Watch:
    """The entities of some nodes that may execute now.

    Attributes:
        deadline_ns: earliest virtual instant at which a timer is due, None when none is running.
        period_ns: that timer's period.
        open: whether something may come from outside unasked: waiting for it for ever is no deadlock.
    """

    def __init__(self, can_execute: Callable[[Any], bool], nodes: Sequence[Node]) -> None:
        self.deadline_ns: int | None = None
        self.period_ns = 0
        self.open = any(
            any(s.handle.link_id for s in node._subscriptions)
            or any(s.handle.link_id for s in node._services)
            for node in nodes
        )
        self._backlogs: list[Any] = []
        self._checked: list[Any] = []
        self._timers: dict[int, bool] = {}
        self._others: set[int] = set()
        self._waitables: list[tuple[Any, WaitSet | None, Node]] = []
        self._nodes = nodes
        for node in nodes:
            for timer in node._timers:
                if can_execute(timer) and not timer.handle.doomed:
                    self._timers[id(timer)] = False
                    self._add_timer(timer.handle)
            for entities in (node._subscriptions, node._clients, node._services, node._guards):
                for entity in entities:
                    if can_execute(entity) and not entity.handle.doomed:
                        self._others.add(id(entity))
                        self._backlogs.append(entity.handle.backlog)
            for waitable in node._waitables:
                if can_execute(waitable):
                    self._add_waitable(waitable, node)

    def _add_timer(self, handle: Any) -> None:
        self._backlogs.append(handle.backlog)
        if handle.canceled:
            return
        due_ns = handle.clock.kernel_deadline_ns(handle.due_ns)
        if due_ns is None:
            self._checked.append(handle)
        elif self.deadline_ns is None or due_ns < self.deadline_ns:
            self.deadline_ns = due_ns
            self.period_ns = handle.get_timer_period()

    def _add_waitable(self, waitable: Any, node: Node) -> None:
        backlogs = getattr(waitable, "_backlogs", None)
        if backlogs is not None:
            if not waitable._doomed():
                self._backlogs.extend(backlogs)
                self._waitables.append((waitable, None, node))
                self.open = self.open or hasattr(waitable, "_timer")
                if hasattr(waitable, "_timer"):
                    self._add_timer(waitable._timer())
            return
        from rclpy.exceptions import InvalidHandle

        waits = WaitSet()
        try:
            waitable.__enter__()
        except InvalidHandle:
            return
        waitable.__exit__(None, None, None)
        waitable.get_num_entities()
        waitable.add_to_wait_set(waits)
        self._backlogs.extend(waits.backlogs())
        for handle in waits.timers():
            self._add_timer(handle)
        self._waitables.append((waitable, waits, node))

    def ready(self) -> bool:
        """Whether something can be served; cheap, asked by the kernel whenever it looks for a thread to run."""
        if any(self._backlogs):
            return True
        return bool(self._checked) and any(handle.is_timer_ready() for handle in self._checked)

    def due(self) -> bool:
        """Whether a timer is due."""
        return self.deadline_ns is not None and self.deadline_ns <= kernel.now_ns

    def settle(self) -> None:
        """Note what is ready now, consuming triggers."""
        for node in self._nodes:
            for timer in node._timers:
                if id(timer) in self._timers:
                    self._timers[id(timer)] = timer.handle.is_timer_ready()
                    timer.handle.backlog.clear()
            for guard in node._guards:
                if id(guard) in self._others and guard.handle.backlog:
                    guard.handle.backlog.clear()
                    guard._executor_triggered = True
            for entities in (node._subscriptions, node._clients, node._services):
                for entity in entities:
                    if not entity.handle.backlog:
                        self._others.discard(id(entity))
        self._waitables = [
            (waitable, waits, node)
            for waitable, waits, node in self._waitables
            if (waitable._poll() if waits is None else _is_ready(waitable, waits))
        ]

    def served(self) -> Iterator[tuple[int, Any, Node]]:
        """Yield what is ready: waitables first, then per node timers, subscriptions, guards, clients, services.

        Each is looked at again when its turn comes: a callback may have cancelled or destroyed it.
        """
        for waitable, _, node in self._waitables:
            if _free(waitable):
                yield WAITABLE, waitable, node
        for node in self._nodes:
            for timer in _entities(node._timers):
                if self._timers.get(id(timer)) and timer.handle.is_timer_ready() and _free(timer):
                    yield TIMER, timer, node
            yield from self._of(SUBSCRIPTION, node._subscriptions, node)
            for guard in _entities(node._guards):
                if guard._executor_triggered and _free(guard):
                    yield GUARD, guard, node
            yield from self._of(CLIENT, node._clients, node)
            yield from self._of(SERVICE, node._services, node)

    def _of(self, kind: int, entities: Sequence[Any], node: Node) -> Iterator[tuple[int, Any, Node]]:
        for entity in _entities(entities):
            if id(entity) in self._others and _free(entity):
                yield kind, entity, node


def _entities(members: Sequence[Any]) -> tuple[Any, ...]:
    """Return the members as they are now: callbacks create and destroy some."""
    return tuple(members)


def _free(entity: Any) -> bool:
    """Whether the entity's callback group lets it run."""
    return bool(entity.callback_group.can_execute(entity))


def _is_ready(waitable: Any, waits: WaitSet) -> bool:
    waits.settle()
    return bool(waitable.is_ready(waits))
