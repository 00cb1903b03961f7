"""Descriptions, actions and substitutions, and the context in which they are evaluated."""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

_DEEPEST = 50


class LaunchContext:
    """What substitutions are evaluated against, and what would have been started.

    Attributes:
        launch_configurations: the launch arguments. namespaces: those that were pushed, outermost first.
        delay_s: how much later than the launch file's start the present actions come.
        started: nodes and other processes, in order. files: launch files under way, outermost first.
    """

    def __init__(self, arguments: dict[str, str]) -> None:
        self.launch_configurations = dict(arguments)
        self.environment = os.environ
        self.namespaces: list[str] = []
        self.parameters: list[dict[str, Any]] = []
        self.delay_s = 0.0
        self.started: list[Any] = []
        self.handlers: list[Any] = []
        self.files: list[str] = []

    def scope(self) -> tuple[Any, ...]:
        """Return what a group changes for its own actions only."""
        return dict(self.launch_configurations), list(self.namespaces), list(self.parameters)

    def restore(self, scope: tuple[Any, ...]) -> None:
        """Go back to an earlier `scope`."""
        self.launch_configurations, self.namespaces, self.parameters = scope

    def perform_substitution(self, substitution: Any) -> str:
        """Return the text of a substitution."""
        return perform(self, substitution)

    def visit(self, entities: Iterable[Any], depth: int = 0) -> None:
        """Do what actions say, in order.

        Raises:
            RuntimeError: descriptions include each other without end.
        """
        if depth > _DEEPEST:
            raise RuntimeError("launch descriptions include each other without end")
        for entity in entities or ():
            if isinstance(entity, LaunchDescription):
                self.visit(entity.entities, depth + 1)
            elif isinstance(entity, Action):
                if entity.condition is None or entity.condition.evaluate(self):
                    entity.execute_in(self, depth + 1)
            else:
                raise TypeError(f"{type(entity).__name__} object is no launch action: {entity!r}")


class LaunchDescription:
    """A list of actions."""

    def __init__(
        self, initial_entities: Iterable[Any] | None = None, *, deprecated_reason: str | None = None
    ) -> None:
        self.entities: list[Any] = list(initial_entities or ())

    def add_action(self, action: Any) -> None:
        """Add an action at the end."""
        self.entities.append(action)

    def add_entity(self, entity: Any) -> None:
        """Add an action at the end."""
        self.entities.append(entity)


class Action:
    """Something that a description says. `condition` tells whether it is done."""

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        """Do it; by default nothing."""


class Substitution:
    """A text that is known when the description is evaluated."""

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        raise NotImplementedError


class Condition:
    """Whether an action is done."""

    def __init__(self, predicate: Callable[[LaunchContext], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether it holds."""
        return self._predicate(context)


def checked(*values: Any) -> None:
    """Check what is to be a string, a substitution, or a list of these; None: it was not given.

    Raises:
        TypeError: it is something else, such as a number.
    """
    for value in values:
        if value is None or isinstance(value, (str, os.PathLike, Substitution)):
            continue
        for each in value:
            if not isinstance(each, (str, os.PathLike, Substitution)):
                raise TypeError(
                    f"Failed to normalize given item of type '{type(each)}', when only "
                    "'str' or 'launch.Substitution' were expected."
                )


def perform(context: LaunchContext, value: Any) -> str:
    """Return the text of a string, a substitution, or a list of these.

    Raises:
        TypeError: it is something else.
    """
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, Substitution):
        return value.perform(context)
    if isinstance(value, (list, tuple)):
        return "".join(perform(context, each) for each in value)
    raise TypeError(
        "Failed to normalize given item of type '{}', when only '{}' were expected.".format(
            type(value), "str, launch.Substitution, os.PathLike"
        )
    )
