"""Descriptions, actions and substitutions, and the context in which they are evaluated."""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

_DEEPEST = 50


class Event:
    """Something that has happened, or is to happen, while a description is carried out."""

    name = "launch.Event"


class ExecutionComplete(Event):
    """An action has been carried out; one that starts a process, when that has ended."""

    name = "launch.events.ExecutionComplete"

    def __init__(self, *, action: Any) -> None:
        self.action = action


class LaunchContext:
    """What substitutions are evaluated against, and what would have been started.

    The arguments and the methods are those of `launch.LaunchContext`, as far as launch files use them.

    Attributes:
        launch_configurations: the launch arguments, and what launch_ros keeps among them.
        delay_s: how much later than the launch file's start the present actions come.
        started: nodes and other processes, in order. files: launch files under way, outermost first.
        events: those that nobody has answered yet, with their delays. handlers: in the order they are asked.
        untold: what of the description is not carried out.
    """

    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False) -> None:
        self.argv = argv if argv is not None else []
        self.noninteractive = noninteractive
        self.is_shutdown = False
        self.launch_configurations: dict[str, Any] = {}
        self.environment = os.environ
        self.delay_s = 0.0
        self.started: list[Any] = []
        self.events: list[tuple[Event, float]] = []
        self.handlers: list[Any] = []
        self.files: list[str] = []
        self.untold: list[str] = []
        self._depth = 0
        self._locals: dict[str, Any] = {}
        self._globals: dict[str, Any] = {}
        self._locals_stack: list[dict[str, Any]] = []
        self._configurations_stack: list[dict[str, Any]] = []
        self._environment_stack: list[dict[str, str]] = []
        self._environment_reset = dict(os.environ)

    @property
    def locals(self) -> Any:
        """What an event's handlers may look at, such as ``context.locals.event``; it cannot be changed."""
        return _Locals(self.get_locals_as_dict())

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Return what `locals` shows."""
        return {**self._globals, **self._locals}

    def extend_locals(self, extensions: dict[str, Any]) -> None:
        """Add to `locals` until the present event has been answered."""
        self._locals.update(extensions)

    def extend_globals(self, extensions: dict[str, Any]) -> None:
        """Add to `locals` for good."""
        self._globals.update(extensions)

    def perform_substitution(self, substitution: Any) -> str:
        """Return the text of a substitution."""
        return perform(self, substitution)

    def register_event_handler(self, event_handler: Any, append: bool = False) -> None:
        """Let a handler answer events, before those that are registered or, if asked for, after them."""
        self.handlers.insert(len(self.handlers) if append else 0, event_handler)

    def unregister_event_handler(self, event_handler: Any) -> None:
        """Let a handler answer no more events. Raises ValueError: it is not registered."""
        if event_handler not in self.handlers:
            raise ValueError("deque.remove(x): x not in deque")
        self.handlers.remove(event_handler)

    def would_handle_event(self, event: Event) -> bool:
        """Return whether any handler would answer an event."""
        return any(handler.matches(event) for handler in self.handlers)

    def emit_event_sync(self, event: Event) -> None:
        """Let an event happen when the present actions come."""
        self.events.append((event, self.delay_s))

    async def emit_event(self, event: Event) -> None:
        """Let an event happen when the present actions come."""
        self.emit_event_sync(event)

    def answer_events(self) -> None:
        """Do what the handlers say of all events that have happened, and of those that follow from them."""
        while self.events:
            event, self.delay_s = self.events.pop(0)
            for handler in [each for each in self.handlers if each.matches(event)]:
                self._locals_stack.append(dict(self._locals))
                entities = handler.handle(event, self)
                self.visit(entities if isinstance(entities, (list, tuple)) else [entities])
                self._locals = self._locals_stack.pop()

    def visit(self, entities: Iterable[Any] | None) -> None:
        """Do what actions say, in order; None among them says nothing.

        Raises RuntimeError: descriptions include each other without end.
        """
        if self._depth > _DEEPEST:
            raise RuntimeError("launch descriptions include each other without end")
        self._depth += 1
        for entity in entities or ():
            if isinstance(entity, LaunchDescription):
                self.visit(entity.entities)
            elif isinstance(entity, Action):
                if entity.condition is None or entity.condition.evaluate(self):
                    entity.execute_in(self)
                    entity.complete_in(self)
            elif entity is not None:
                raise TypeError(f"{type(entity).__name__} object is no launch action: {entity!r}")
        self._depth -= 1

    def _push_launch_configurations(self) -> None:
        self._configurations_stack.append(dict(self.launch_configurations))

    def _pop_launch_configurations(self) -> None:
        if not self._configurations_stack:
            raise RuntimeError("launch_configurations stack unexpectedly empty")
        self.launch_configurations = self._configurations_stack.pop()

    def _push_environment(self) -> None:
        self._environment_stack.append(dict(os.environ))

    def _pop_environment(self) -> None:
        if not self._environment_stack:
            raise RuntimeError("environment stack unexpectedly empty")
        set_environment(self._environment_stack.pop())

    def _reset_environment(self) -> None:
        set_environment(self._environment_reset)


class _Locals:
    """The attributes that a dictionary has, to be looked at."""

    def __init__(self, values: dict[str, Any]) -> None:
        self.__dict__["_values"] = values

    def __getattr__(self, key: str) -> Any:
        values = self.__dict__["_values"]
        if key not in values:
            raise AttributeError(
                f"context.locals does not contain attribute '{key}', it contains: [{', '.join(values)}]"
            )
        return values[key]

    def __setattr__(self, key: str, value: Any) -> None:
        raise AttributeError(f"can't set attribute '{key}', locals are read-only")


def set_environment(values: dict[str, str]) -> None:
    """Let the environment have these values and no other."""
    os.environ.clear()
    os.environ.update(values)


class LaunchDescriptionEntity:
    """Whatever can stand in a description."""


class LaunchDescription(LaunchDescriptionEntity):
    """A list of actions."""

    def __init__(
        self, initial_entities: Iterable[Any] | None = None, *, deprecated_reason: str | None = None
    ) -> None:
        self.entities: list[Any] = list(initial_entities or ())
        self.deprecated_reason = deprecated_reason

    @property
    def deprecated(self) -> bool:
        """Whether a reason was given not to use it."""
        return self.deprecated_reason is not None

    def add_action(self, action: Any) -> None:
        """Add an action at the end."""
        self.entities.append(action)

    def add_entity(self, entity: Any) -> None:
        """Add an action at the end."""
        self.entities.append(entity)


class Action(LaunchDescriptionEntity):
    """Something that a description says. `condition` tells whether it is done."""

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    def execute(self, context: LaunchContext) -> Any:
        """Do it, and return what is to be done next; to be overridden, as upstream's."""

    def execute_in(self, context: LaunchContext) -> None:
        """Do it, with all that follows from it."""
        context.visit(self.execute(context))

    def complete_in(self, context: LaunchContext) -> None:
        """Let the end of it be an event, if anybody waits for that."""
        event = ExecutionComplete(action=self)
        if context.would_handle_event(event):
            self.end_in(context, event)

    def end_in(self, context: LaunchContext, event: Event) -> None:
        """Let the event happen that is the end of it: by default at once."""
        context.emit_event_sync(event)


class Substitution:
    """A text that is known when the description is evaluated."""

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        raise NotImplementedError

    def describe(self) -> str:
        """Return what it is called in messages."""
        return type(self).__name__


class Condition:
    """Whether an action is done."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether it holds; without a predicate it does not."""
        return self._predicate is not None and self._predicate(context)


def checked(*values: Any) -> None:
    """Check what is to be a string, a substitution, or a list of these; None: it was not given.

    Raises TypeError: it is something else, such as a number.
    """
    for value in values:
        if value is None or isinstance(value, (str, os.PathLike, Substitution)):
            continue
        for part in value:
            if not isinstance(part, (str, os.PathLike, Substitution)):
                raise TypeError(
                    f"Failed to normalize given item of type '{type(part)}', when only "
                    "'str' or 'launch.Substitution' were expected."
                )


def perform(context: LaunchContext, value: Any) -> str:
    """Return the text of a string, a substitution, or a list of these.

    Raises TypeError: it is something else.
    """
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, Substitution):
        return value.perform(context)
    if isinstance(value, (list, tuple)):
        return "".join(perform(context, part) for part in value)
    raise TypeError(
        "Failed to normalize given item of type '{}', when only '{}' were expected.".format(
            type(value), "str, launch.Substitution, os.PathLike"
        )
    )


_YAML_TRUE = frozenset(word for each in ("yes", "true", "on") for word in (each, each.title(), each.upper()))
_YAML_FALSE = frozenset(
    word for each in ("no", "false", "off") for word in (each, each.title(), each.upper())
)


def perform_bool(context: LaunchContext, value: Any) -> bool:
    """Return the truth that a text is in YAML 1.1, or a bool itself.

    Raises ValueError: it is neither true nor false.
    """
    if isinstance(value, bool):
        return value
    text = perform(context, value)
    if text not in _YAML_TRUE | _YAML_FALSE:
        raise ValueError(f"Cannot convert value '{text}' to '{bool}'")
    return text in _YAML_TRUE
