"""Who answers an event: what all handlers share, and those that neither processes nor descriptions need."""

from __future__ import annotations

from collections.abc import Iterable

from launch._evaluation import Action, Event, LaunchContext, LaunchDescriptionEntity

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any


def event_named(name: str) -> Callable[[Event], bool]:
    """Return what recognises events by their names, such as ``launch.events.Shutdown``."""
    return lambda event: event.name == name


class BaseEventHandler:
    """Answers the events that `matcher` chooses.

    Attributes:
        never: what it waits for, if that never comes here; empty otherwise.
    """

    never = ""

    def __init__(self, *, matcher: Callable[[Event], bool], handle_once: bool = False) -> None:
        self._matcher = matcher
        self.handle_once = handle_once

    def matches(self, event: Event) -> bool:
        """Return whether it answers an event."""
        return self._matcher(event)

    def handle(self, event: Event, context: LaunchContext) -> Any:
        """Return what is to be done; the event is in the context's locals from then on."""
        context.extend_locals({"event": event})
        if self.handle_once:
            context.unregister_event_handler(self)


class EventHandler(BaseEventHandler):
    """Actions for the events that `matcher` chooses."""

    def __init__(
        self, *, matcher: Callable[[Event], bool], entities: Any = None, handle_once: bool = False
    ) -> None:
        super().__init__(matcher=matcher, handle_once=handle_once)
        self.entities = entities

    def handle(self, event: Event, context: LaunchContext) -> Any:
        super().handle(event, context)
        return self.entities


class OnActionEventBase(BaseEventHandler):
    """Actions, or a function that returns them, for one kind of event of one action, or of all.

    Raises TypeError: the action is none, or what is to be done is not made of actions.
    """

    def __init__(
        self,
        *,
        action_matcher: Any,
        on_event: Any,
        target_event_cls: type[Event],
        target_action_cls: type[Action],
        **kwargs: Any,
    ) -> None:
        if not isinstance(action_matcher, (target_action_cls, type(None))) and not callable(action_matcher):
            raise TypeError(
                f"action_matcher must be an '{target_action_cls.__name__}' instance or a callable"
            )

        def matches(event: Any) -> bool:
            if not isinstance(event, target_event_cls):
                return False
            action = getattr(event, "action", None)
            if callable(action_matcher):
                return bool(action_matcher(action))
            return action_matcher is None or action is action_matcher

        super().__init__(matcher=matches, **kwargs)
        if not callable(on_event):
            on_event = list(on_event) if isinstance(on_event, Iterable) else [on_event]
            for entity in on_event:
                if not isinstance(entity, LaunchDescriptionEntity):
                    raise TypeError(
                        "expected all items in 'on_event' iterable to be of type "
                        f"'LaunchDescriptionEntity' but got '{type(entity)}'"
                    )
        self._on_event = on_event

    def handle(self, event: Event, context: LaunchContext) -> Any:
        super().handle(event, context)
        return self._on_event(event, context) if callable(self._on_event) else self._on_event
