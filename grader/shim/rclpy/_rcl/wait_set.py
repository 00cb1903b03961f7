"""The wait set that a custom `Waitable` sees: which of its entities are ready."""

from __future__ import annotations

from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")


def _adder(kind: str) -> Any:
    def add(self: WaitSet, handle: Any) -> int:
        """Add an entity; return its index."""
        handle.require()
        members = self._members[kind]
        members.append(handle)
        return len(members) - 1

    return add


class WaitSet:
    """Entities by kind; their place in it is the index asked for later."""

    def __init__(self, *_sizes: Any) -> None:
        self._members: dict[str, list[Any]] = {kind: [] for kind in KINDS}
        self._ready: dict[str, list[bool]] = {}

    def clear_entities(self) -> None:
        """Forget all entities."""
        for members in self._members.values():
            members.clear()
        self._ready = {}

    add_subscription = _adder("subscription")
    add_guard_condition = _adder("guard_condition")
    add_timer = _adder("timer")
    add_client = _adder("client")
    add_service = _adder("service")
    add_event = _adder("event")

    def backlogs(self) -> list[Any]:
        """Return what becomes true when an entity is ready."""
        return [handle.backlog for members in self._members.values() for handle in members]

    def timers(self) -> list[Any]:
        """Return the timer handles."""
        return self._members["timer"]

    def settle(self) -> bool:
        """Note which entities are ready now, consuming triggers; whether any is."""
        self._ready = {
            kind: [handle.is_timer_ready() if kind == "timer" else bool(handle.backlog) for handle in members]
            for kind, members in self._members.items()
        }
        for handle in self._members["guard_condition"]:
            handle.backlog.clear()
        return any(any(flags) for flags in self._ready.values())

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether the entity at `index` of a kind was ready at the last wait."""
        if kind not in self._members:
            raise RuntimeError(f"'{kind}' is not a known entity")
        flags = self._ready.get(kind, ())
        if not 0 <= index < len(self._members[kind]):
            raise IndexError("wait set index too big for ready list")
        return bool(flags) and flags[index]

    def get_ready_entities(self, kind: str) -> list[int]:
        """Return the pointers of the ready entities of a kind."""
        flags = self._ready.get(kind, ())
        return [handle.pointer for handle, flag in zip(self._members[kind], flags, strict=False) if flag]

    def wait(self, timeout_ns: int) -> None:
        """Block until an entity is ready or the timeout (-1: never) has passed."""
        due = [t.clock.kernel_deadline_ns(t.due_ns) for t in self.timers() if not t.canceled]
        if timeout_ns >= 0:
            due.append(kernel.now_ns + timeout_ns)
        backlogs, timers = self.backlogs(), self.timers()
        kernel.wait(
            lambda: any(backlogs) or any(timer.is_timer_ready() for timer in timers),
            min((at for at in due if at is not None), default=None),
            "a wait set",
        )
        self.settle()
