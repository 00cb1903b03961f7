"""What is to be done when something happens. A command, which is not run here, counts as ended at once."""

from __future__ import annotations

from launch._evaluation import Action, Event, LaunchContext
from launch._handlers import BaseEventHandler, EventHandler, OnActionEventBase, event_named
from launch.actions import ExecuteLocal
from launch.events import ExecutionComplete, IncludeLaunchDescription, Shutdown
from launch.events.process import ProcessExited, ProcessIO, ProcessStarted

TYPE_CHECKING = False
if TYPE_CHECKING:
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


class _OnProcessEvent(OnActionEventBase):
    """Actions for one kind of event of one process, or of all."""

    def __init__(self, target_action: Any, on_event: Any, kind: type[Event], **kwargs: Any) -> None:
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
            actions = (
                (event.from_stdout, on_stdout),
                (event.from_stderr, on_stderr),
                (event.from_stdin, on_stdin),
            )
            return next((call(event) for holds, call in actions if holds and call is not None), None)

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
