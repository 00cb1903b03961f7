"""Which callbacks of a node may run at the same time."""

from __future__ import annotations

from _weakref import ref

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class CallbackGroup:
    """Base of the groups; a custom one defines the three methods about execution."""

    def __init__(self) -> None:
        super().__init__()
        self.entities: set[ref[Any]] = set()

    def add_entity(self, entity: Any) -> None:
        """Add a timer, subscription, service, client, guard condition or waitable."""
        self.entities.add(ref(entity))

    def has_entity(self, entity: Any) -> bool:
        """Whether the entity belongs to the group."""
        return ref(entity) in self.entities

    def can_execute(self, entity: Any) -> bool:
        """Whether a callback of `entity` may begin now."""
        raise NotImplementedError()

    def beginning_execution(self, entity: Any) -> bool:
        """Note that a callback is about to begin; False forbids it."""
        raise NotImplementedError()

    def ending_execution(self, entity: Any) -> None:
        """Note that a callback has ended."""
        raise NotImplementedError()


class ReentrantCallbackGroup(CallbackGroup):
    """Callbacks may overlap."""

    def can_execute(self, entity: Any) -> bool:
        return True

    def beginning_execution(self, entity: Any) -> bool:
        return True

    def ending_execution(self, entity: Any) -> None:
        pass


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    """One callback at a time."""

    def __init__(self) -> None:
        super().__init__()
        self._active_entity: Any = None

    def can_execute(self, entity: Any) -> bool:
        assert ref(entity) in self.entities
        return self._active_entity is None

    def beginning_execution(self, entity: Any) -> bool:
        if self._active_entity is not None:
            return False
        self._active_entity = entity
        return True

    def ending_execution(self, entity: Any) -> None:
        assert self._active_entity == entity
        self._active_entity = None
