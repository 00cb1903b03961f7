"""What is to be done when something happens. A command, which is not run here, counts as ended at once."""

from __future__ import annotations

from collections.abc import Iterable

from launch._evaluation import Action, Event, LaunchContext, LaunchDescriptionEntity
from launch.events import ExecutionComplete, IncludeLaunchDescription, Shutdown
from launch.events.process import ProcessExited, ProcessIO, ProcessStarted

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

__all__ = [
    "OnExecutionComplete",
    "OnIncludeLaunchDescription",
    "OnProcessExit",
    "OnProcessIO",
    "OnProcessStart",
    "OnShutdown",
    "event_named",
]


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

    Raises:
        TypeError: the action is none, or what is to be done is not made of actions.
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


class _OnProcessEvent(OnActionEventBase):
    """Actions for one kind of event of one process, or of all."""

    def __init__(self, target_action: Any, on_event: Any, kind: type[Event], **kwargs: Any) -> None:
        from launch.actions import ExecuteLocal

        super().__init__(
            action_matcher=target_action,
            on_event=on_event,
            target_event_cls=kind,
            target_action_cls=ExecuteLocal,
            **kwargs,
        )


class OnProcessStart(_OnProcessEvent):
    """Actions for the start of a process."""

    def __init__(self, *, target_action: Any = None, on_start: Any, **kwargs: Any) -> None:
        super().__init__(target_action, on_start, ProcessStarted, **kwargs)


class OnProcessExit(_OnProcessEvent):
    """Actions for the end of a process."""

    def __init__(self, *, target_action: Any = None, on_exit: Any, **kwargs: Any) -> None:
        super().__init__(target_action, on_exit, ProcessExited, **kwargs)


class OnProcessIO(_OnProcessEvent):
    """Actions for what a process prints, of which launch is told nothing here."""

    never = "OnProcessIO"

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **kwargs: Any,
    ) -> None:
        def answer(event: ProcessIO, _: LaunchContext) -> Any:
            given = (
                (event.from_stdout, on_stdout),
                (event.from_stderr, on_stderr),
                (event.from_stdin, on_stdin),
            )
            return next((call(event) for holds, call in given if holds and call is not None), None)

        super().__init__(target_action, answer, ProcessIO, **kwargs)


class OnExecutionComplete(OnActionEventBase):
    """Actions for the end of an action; of one that starts a process, when that has ended."""

    def __init__(self, *, target_action: Any = None, on_completion: Any, **kwargs: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_completion,
            target_event_cls=ExecutionComplete,
            target_action_cls=Action,
            **kwargs,
        )


class OnShutdown(BaseEventHandler):
    """Actions, or a function that returns them, for the end of everything."""

    def __init__(self, *, on_shutdown: Any, **kwargs: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), **kwargs)
        self._on_shutdown = on_shutdown

    def handle(self, event: Event, context: LaunchContext) -> Any:
        super().handle(event, context)
        return self._on_shutdown(event, context) if callable(self._on_shutdown) else self._on_shutdown


class OnIncludeLaunchDescription(EventHandler):
    """Carries out the descriptions that are included by an event."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, IncludeLaunchDescription), **kwargs)

    def handle(self, event: Any, context: LaunchContext) -> Any:
        super().handle(event, context)
        return [event.launch_description]
