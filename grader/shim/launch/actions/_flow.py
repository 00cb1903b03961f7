"""What is done later, elsewhere or by the launch file's own functions."""

from __future__ import annotations

import inspect
import sys
import warnings
from collections.abc import Iterable

from launch._evaluation import Action, Event, LaunchContext, Substitution, checked, perform
from launch.actions._scopes import SetLaunchConfiguration
from launch.events import Shutdown as ShutdownEvent
from launch.events.process import ProcessExited, ProcessTargetedEvent

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class LogInfo(Action):
    """Prints a line, as launch does."""

    def __init__(self, *, msg: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(msg)
        self.msg = msg

    def execute(self, context: LaunchContext) -> None:
        sys.stdout.write(f"[INFO] [launch.user]: {perform(context, self.msg)}\n")


class OpaqueFunction(Action):
    """A function that returns actions."""

    def __init__(
        self,
        *,
        function: Any,
        args: Iterable[Any] | None = None,
        kwargs: dict[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if not callable(function):
            raise TypeError(f"OpaqueFunction expected a callable for 'function', got '{type(function)}'")
        self._function = function
        self._args = () if args is None else args
        self._kwargs = kwargs or {}

    def execute(self, context: LaunchContext) -> Any:
        return self._function(context, *self._args, **self._kwargs)


class OpaqueCoroutine(Action):
    """A coroutine function, which is carried out to its end before the next action."""

    def __init__(
        self,
        *,
        coroutine: Any,
        args: Iterable[Any] | None = None,
        kwargs: dict[str, Any] | None = None,
        ignore_context: bool = False,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if not inspect.iscoroutinefunction(coroutine):
            raise TypeError(
                f"OpaqueCoroutine expected a coroutine function for 'coroutine', got '{type(coroutine)}'"
            )
        self._coroutine = coroutine
        self._args = () if args is None else args
        self._kwargs = kwargs or {}
        self._ignore_context = ignore_context

    def execute(self, context: LaunchContext) -> None:
        import asyncio

        first = () if self._ignore_context else (context,)
        asyncio.run(self._coroutine(*first, *self._args, **self._kwargs))


class TimerAction(Action):
    """Actions that come later. Raises TypeError: the time is an integer, or no time at all."""

    def __init__(self, *, period: Any, actions: Any, cancel_on_shutdown: Any = True, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(period, (float, str, Substitution, Iterable)):
            kinds = f"{str}, <class 'launch.substitution.Substitution'>, {Iterable}, {float}"
            expected = f"'TimerAction' expected 'period' to be one of [{kinds}]"
            raise TypeError(f"{expected}, but got '{period}' of type '{type(period)}'")
        if isinstance(period, str):
            period = float(period)
            warnings.warn(
                "The parameter 'period' must be a float or substitution,"
                "passing a string literal was deprecated",
                stacklevel=2,
            )
        self.period = period
        self.actions = actions
        self._canceled = False

    def cancel(self) -> None:
        """Let the actions not come, if they have not been described yet."""
        self._canceled = True

    def execute_in(self, context: LaunchContext) -> None:
        if self._canceled:
            return
        before_s = context.delay_s
        context.delay_s += self._period_s(context)
        context.visit(self.actions)
        context.delay_s = before_s

    def end_in(self, context: LaunchContext, event: Event) -> None:
        context.events.append((event, context.delay_s + self._period_s(context)))

    def _period_s(self, context: LaunchContext) -> float:
        return self.period if isinstance(self.period, float) else float(perform(context, self.period))


class IncludeLaunchDescription(Action):
    """The actions of another launch file, or of a description."""

    def __init__(
        self, launch_description_source: Any, *, launch_arguments: Any = None, **options: Any
    ) -> None:
        super().__init__(**options)
        from launch.launch_description_sources import AnyLaunchDescriptionSource, LaunchDescriptionSource

        if not isinstance(launch_description_source, LaunchDescriptionSource):
            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_description_source = launch_description_source
        self.launch_arguments = () if launch_arguments is None else tuple(launch_arguments)

    def execute_in(self, context: LaunchContext) -> None:
        source = self.launch_description_source
        description = source.get_launch_description(context)
        context.visit([SetLaunchConfiguration(name, value) for name, value in self.launch_arguments])
        context.files.append(source.location)
        context.visit([description])
        context.files.pop()


class RegisterEventHandler(Action):
    """Lets a handler answer events from then on."""

    def __init__(self, event_handler: Any, **options: Any) -> None:
        super().__init__(**options)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        if self.event_handler.never:
            context.untold.append(self.event_handler.never)
        context.register_event_handler(self.event_handler)


class UnregisterEventHandler(Action):
    """Lets a handler answer no more events.

    Raises, when it is carried out:
        ValueError: it is not registered.
    """

    def __init__(self, event_handler: Any, **options: Any) -> None:
        super().__init__(**options)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        context.unregister_event_handler(self.event_handler)


class EmitEvent(Action):
    """Lets an event happen. Raises RuntimeError: it is none."""

    def __init__(self, *, event: Any, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(event, Event):
            raise RuntimeError(f"EmitEvent() expected an event instance, got '{event}'.")
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        if isinstance(self.event, ProcessTargetedEvent) or getattr(self.event, "untold", False):
            context.untold.append(type(self.event).__name__)
        context.emit_event_sync(self.event)


class Shutdown(EmitEvent):
    """The end of everything: each process gets Ctrl+C."""

    def __init__(self, *, reason: Any = "reason not given", **options: Any) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), **options)

    def execute(self, context: LaunchContext) -> None:
        event = context.get_locals_as_dict().get("event")
        if isinstance(event, ProcessExited):
            sys.stdout.write(
                f"[INFO] [launch]: process[{event.process_name}] was required: shutting down launched system\n"
            )
        super().execute(context)
