"""One wait of an executor: which entities count, until when to block, and in which order they are served."""

from __future__ import annotations

from heapq import heappop, heappush, heapreplace

from rclpy._kernel import kernel
from rclpy._rcl.handles import changes
from rclpy._rcl.wait_set import WaitSet
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.task import is_coroutine_function

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Any

    from rclpy.node import Node

    Place = tuple[int, int, int, Any, Node]
    """Number of the node, kind, place among the node's entities of that kind, entity and node."""

TIMER, SUBSCRIPTION, GUARD, CLIENT, SERVICE, WAITABLE = range(6)

_PLAIN_GROUPS = (MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup)
"""A group of another class may say at any time whether its callbacks may run."""

MAX_LATENESS_NS = 5_000_000
"""How late a timer may be called if nothing else keeps the executor busy."""


class Watch:
    """The entities of some nodes that may execute now.

    Looking through all entities costs more than most callbacks do. So one watch serves many waits, until an entity
    is added or removed (`holds`). It keeps timers in a heap by the instant at which they are due, and asks of all
    others only whether anything has arrived.

    Attributes:
        deadline_ns: earliest virtual instant at which a timer is due, None when none is running.
        late_ns: how much later than that it may be called (`Kernel.be_late`).
        ended_ns: when the last wait ended, without that lateness.
        open: whether something may come from outside unasked: waiting for it for ever is no deadlock.
        lasting: whether it may serve a further wait.
        given_out: callbacks that were under way (`Changes.given_out`); it serves only waits with the same ones.
    """

    def __init__(self, can_execute: Callable[[Any], bool], nodes: Sequence[Node]) -> None:
        self.deadline_ns: int | None = None
        self.late_ns = 0
        self.ended_ns = 0
        self.open = False
        self._nodes = list(nodes)
        self._seen = changes.count
        self._seen_additions = changes.additions
        self.lasting = True
        self.given_out = changes.given_out()
        self._can_execute = can_execute
        self._backlogs: list[Any] = []
        self._reset: list[Any] = []  # backlogs of timers, which a reset before the wait has filled
        self._checked: list[Any] = []
        # Handle, how far its clock leads, whose it is.
        self._clockwork: list[tuple[Any, int, Place | None]] = []
        self._heap: list[tuple[int, int]] = []  # when it is due, number in the clockwork
        self._others: list[tuple[Any, Place]] = []
        self._guards: list[tuple[Any, Place]] = []
        self._waitables: list[tuple[Any, WaitSet | None, Node]] = []
        # Backlogs of waitables, if these are ready only when they hold something.
        self._events: list[Any] = []
        self._plain: Any = None  # the last callback that was found to be no coroutine function
        self._first: Place | None = None  # the timer of `deadline_ns`
        self._timed = False  # whether a waitable may become ready without one
        self._calm = False  # whether none of those was ready at the last look
        self._quiet = False  # whether only timers of the heap and messages can have become ready since
        self._ready: list[Place] = []
        self._ready_waitables: list[tuple[Any, Node]] = []
        for number, node in enumerate(nodes):
            self._known = [0] * (WAITABLE + 1)
            self._add_node(number, node)
        self._find_deadline()

    def _add_node(self, number: int, node: Node) -> None:
        """Count those of the node's entities that are not counted yet."""
        self._quiet = False
        known, members = self._known, _members(node)
        for place, timer in enumerate(members[TIMER][known[TIMER] :], known[TIMER]):
            if self._counts(timer):
                self._add_timer(timer.handle, (number, TIMER, place, timer, node))
        for kind in (SUBSCRIPTION, CLIENT, SERVICE):
            for place, entity in enumerate(members[kind][known[kind] :], known[kind]):
                counts, handle = self._counts(entity), entity.handle
                if kind != CLIENT and handle.link_id:
                    self.open = True
                if counts:
                    self._backlogs.append(handle.backlog)
                    self._others.append((handle.backlog, (number, kind, place, entity, node)))
        if len(members[GUARD]) > known[GUARD]:
            counted = [guard for guard in members[GUARD] if self._counts(guard)]
            self._backlogs.extend(guard.handle.backlog for guard in counted)
            self._guards.append((counted, (number, GUARD, 0, None, node)))
        for waitable in members[WAITABLE][known[WAITABLE] :]:
            if self._can_execute(waitable):
                self._add_waitable(waitable, node)
        self._known = [len(member) for member in members]

    def _take_in(self) -> bool:
        """Count what the only node has got since. False: something else has changed; throw the watch away."""
        if len(self._nodes) != 1 or changes.count - self._seen != changes.additions - self._seen_additions:
            return False
        node = self._nodes[0]
        if len(_members(node)[GUARD]) != self._known[GUARD]:
            return False
        self._seen, self._seen_additions = changes.count, changes.additions
        self._add_node(0, node)
        return self.lasting

    def _counts(self, entity: Any) -> bool:
        free = self._can_execute(entity)  # first, as upstream: what is no entity fails here
        if self.lasting and type(entity.callback_group) not in _PLAIN_GROUPS:
            self.lasting = False
        return free and not entity.handle.doomed

    def _add_timer(self, handle: Any, place: Place | None) -> None:
        self._reset.append(handle.backlog)
        due_ns = handle.clock.kernel_deadline_ns(handle.due_ns)
        if due_ns is None:
            self.lasting = False
            self._checked.append((handle, place))
        else:
            heappush(self._heap, (due_ns, len(self._clockwork)))
            self._clockwork.append((handle, handle.due_ns - due_ns, place))

    def _add_waitable(self, waitable: Any, node: Node) -> None:
        backlogs = getattr(waitable, "_backlogs", None)
        if backlogs is not None:
            if not waitable._doomed():
                self._backlogs.extend(backlogs)
                self._waitables.append((waitable, None, node))
                self._events.extend(backlogs)
                if hasattr(waitable, "_timer"):
                    self.open = self._timed = True
                    self._add_timer(waitable._timer(), None)
            return
        from rclpy.exceptions import InvalidHandle

        self.lasting = False
        waits = WaitSet()
        try:
            waitable.__enter__()
        except InvalidHandle:
            return
        waitable.__exit__(None, None, None)
        waitable.get_num_entities()
        waitable.add_to_wait_set(waits)
        self._timed = True
        self._backlogs.extend(waits.backlogs())
        for handle in waits.timers():
            self._add_timer(handle, None)
        self._waitables.append((waitable, waits, node))

    def holds(self, can_execute: Callable[[Any], bool], nodes: Sequence[Node]) -> bool:
        """Whether the next wait would count the same entities; if so, it is ready for that wait."""
        return can_execute == self._can_execute and nodes == self._nodes and self.unchanged()

    def unchanged(self) -> bool:
        """Whether the next wait for these nodes counts the same entities; if so, it is ready for that wait."""
        if not self.lasting or (changes.count != self._seen and not self._take_in()):
            return False
        if self._heap:
            self._find_deadline()
        return True

    def _find_deadline(self) -> None:
        """Look up when the next timer is due. One that was called meanwhile is due later than the heap says."""
        heap = self._heap
        while heap:
            due_ns, number = heap[0]
            handle, lead_ns, place = self._clockwork[number]
            if handle.canceled:
                heappop(heap)  # a reset is a change
            elif handle.due_ns - lead_ns != due_ns:
                heapreplace(heap, (handle.due_ns - lead_ns, number))
            else:
                late_ns = handle.period_ns // 5
                self.deadline_ns = due_ns
                self._first = place
                self.late_ns = late_ns if late_ns < MAX_LATENESS_NS else MAX_LATENESS_NS
                return
        self.deadline_ns = None

    def ready(self) -> bool:
        """Whether something can be served; cheap, asked by the kernel whenever it looks for a thread to run."""
        if changes.count != self._seen or any(self._backlogs) or (self._reset and any(self._reset)):
            return True  # a change during the wait: another thread may have reset a timer, which wakes as at home
        if self._guards and any(guard._executor_triggered for guards, _ in self._guards for guard in guards):
            return True  # found by the last wait, but given up with the rest of what that wait found
        return bool(self._checked) and any(handle.is_timer_ready() for handle, _ in self._checked)

    def is_plain(self, callback: Any) -> bool:
        """Whether the callback is no coroutine function."""
        if callback is not self._plain:
            if is_coroutine_function(callback):
                return False
            self._plain = callback
        return True

    def lone_timer(self) -> Place | None:
        """Return the timer that is due next; None when anything else may be ready by then, or soon after it."""
        heap = self._heap
        if not heap or self._reset or self._guards or any(self._backlogs):
            return None
        if len(heap) > 1:
            soon_ns = heap[0][0] + MAX_LATENESS_NS
            if heap[1][0] <= soon_ns or (len(heap) > 2 and heap[2][0] <= soon_ns):
                return None
        return self._first

    def lone_message(self, heard: tuple[int, ...]) -> Place | None:
        """Return the subscription that has got a message, if nothing else can be ready.

        None: call `settle` and `lone` instead.

        `heard` are all that got it. Nothing was ready before, no timer is due, and nothing of the script has run.
        """
        if len(heard) == 1 and self._quiet and changes.count == self._seen:
            for backlog, place in self._others:
                if backlog:
                    return place
        return None

    @property
    def idle(self) -> bool:
        """Whether nothing was ready at the last `settle`."""
        return not self._ready and not self._ready_waitables

    def lone(self) -> Place | None:
        """Return the timer or subscription that is ready, after `settle`, if it is the only thing that is."""
        if len(self._ready) != 1 or self._ready_waitables:
            return None
        place = self._ready[0]
        _, kind, _, entity, node = place
        plain = kind in (TIMER, SUBSCRIPTION) and self._is_there(kind, entity, node)
        return place if plain and _free(entity) else None

    def _is_there(self, kind: int, entity: Any, node: Node) -> bool:
        """Whether the node still has the entity: a callback, or another thread during the wait, may destroy it."""
        return changes.count == self._seen or entity in _members(node)[kind]

    def settle(self) -> None:
        """Note what is ready now, consuming triggers."""
        ready = self._due_timers() if self._heap or self._checked else []
        if self._reset or changes.count != self._seen:
            self._reset = []
            for handle in [handle for handle, *_ in self._clockwork + self._checked]:
                handle.backlog.clear()
        for guards, place in self._guards:
            for guard in guards:
                if guard.handle.backlog:
                    guard.handle.backlog.clear()
                    guard._executor_triggered = True
            ready.append(place)
        if any(self._backlogs):
            ready += [place for backlog, place in self._others if backlog]
        if len(ready) > 1:
            ready.sort(key=_order)
        self._ready = ready
        if not self._calm or any(self._events):
            self._ready_waitables = [
                (waitable, node)
                for waitable, waits, node in self._waitables
                if (waitable._poll() if waits is None else _is_ready(waitable, waits))
            ]
            self._calm = not self._ready_waitables and not self._timed
        self._quiet = self._calm and self.lasting and not (self._guards or self._checked)

    def _due_timers(self) -> list[Place]:
        now_ns = kernel.now_ns
        due = [place for handle, place in self._checked if place is not None and handle.is_timer_ready()]
        heap = self._heap
        if not heap or heap[0][0] > now_ns:
            return due
        popped = []
        while heap and heap[0][0] <= now_ns:
            popped.append(heappop(heap))
        for item in popped:
            handle, _, place = self._clockwork[item[1]]
            if place is not None and handle.is_timer_ready():
                due.append(place)
            heappush(heap, item)
        return due

    def served(self) -> Iterator[tuple[int, Any, Node]]:
        """Yield what is ready: waitables first, then per node timers, subscriptions, guards, clients, services.

        Each is looked at again when its turn comes: a callback may have cancelled or destroyed it.
        """
        for waitable, node in self._ready_waitables:
            if self._is_there(WAITABLE, waitable, node) and _free(waitable):
                yield WAITABLE, waitable, node
        for _, kind, _, entity, node in self._ready:
            if kind == GUARD:
                for guard in tuple(node._guards):  # callbacks create and destroy some
                    if guard._executor_triggered and _free(guard):
                        yield GUARD, guard, node
            elif (
                self._is_there(kind, entity, node)
                and (kind != TIMER or entity.handle.is_timer_ready())
                and _free(entity)
            ):
                yield kind, entity, node


def _order(place: Place) -> tuple[int, int, int]:
    return place[:3]


def _members(node: Node) -> tuple[list[Any], ...]:
    """Return what a node consists of, by kind. A script may keep a dict of its own under one of the names."""
    members: tuple[Any, ...] = (
        node._timers,
        node._subscriptions,
        node._guards,
        node._clients,
        node._services,
        node._rcl_waitables,
    )
    return tuple(member if type(member) is list else list(member) for member in members)


def _free(entity: Any) -> bool:
    """Whether the entity's callback group lets it run."""
    return bool(entity.callback_group.can_execute(entity))


def _is_ready(waitable: Any, waits: WaitSet) -> bool:
    waits.settle()
    return bool(waitable.is_ready(waits))
