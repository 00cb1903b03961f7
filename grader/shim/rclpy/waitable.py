"""Custom things an executor can wait for."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy._rcl.wait_set import WaitSet
    from rclpy.callback_groups import CallbackGroup
    from rclpy.task import Future

_COUNTS = (
    "num_subscriptions",
    "num_guard_conditions",
    "num_timers",
    "num_clients",
    "num_services",
    "num_events",
)


class NumberOfEntities:
    """How many entities of each kind a waitable adds to a wait set."""

    __slots__ = list(_COUNTS)

    def __init__(
        self,
        num_subs: int = 0,
        num_gcs: int = 0,
        num_timers: int = 0,
        num_clients: int = 0,
        num_services: int = 0,
        num_events: int = 0,
    ) -> None:
        self.num_subscriptions = num_subs
        self.num_guard_conditions = num_gcs
        self.num_timers = num_timers
        self.num_clients = num_clients
        self.num_services = num_services
        self.num_events = num_events

    def _values(self) -> list[int]:
        return [getattr(self, name) for name in _COUNTS]

    def __add__(self, other: NumberOfEntities) -> NumberOfEntities:
        return type(self)(*(a + b for a, b in zip(self._values(), other._values(), strict=True)))

    def __repr__(self) -> str:
        return f"<{type(self).__name__}({', '.join(map(str, self._values()))})>"


class Waitable:
    """Base of the things a node can have an executor wait for besides its own entities."""

    def __init__(self, callback_group: CallbackGroup) -> None:
        self.callback_group = callback_group
        self.callback_group.add_entity(self)
        self._executor_event = False
        self._futures: list[Future] = []

    def __enter__(self) -> None:
        """Begin to be waited for."""

    def __exit__(self, *_: object) -> None:
        """End being waited for."""

    def add_future(self, future: Future) -> None:
        """Have the executor that runs this waitable schedule the future's done callbacks."""
        self._futures.append(future)

    def remove_future(self, future: Future) -> None:
        """Undo `add_future`."""
        self._futures.remove(future)

    def is_ready(self, wait_set: WaitSet) -> bool:
        """Whether there is work after a wait."""
        raise NotImplementedError("Must be implemented by subclass")

    def take_data(self) -> Any:
        """Take the data so that the next wait does not end at once."""
        raise NotImplementedError("Must be implemented by subclass")

    async def execute(self, taken_data: Any) -> None:
        """Do the work."""
        raise NotImplementedError("Must be implemented by subclass")

    def get_num_entities(self) -> NumberOfEntities:
        """Return how many entities `add_to_wait_set` adds."""
        raise NotImplementedError("Must be implemented by subclass")

    def add_to_wait_set(self, wait_set: WaitSet) -> None:
        """Add the entities to wait for."""
        raise NotImplementedError("Must be implemented by subclass")
