"""Launch arguments and environment variables: what sets them, and the scopes in which that holds."""

from __future__ import annotations

import os

from launch._evaluation import Action, LaunchContext, checked, perform, perform_bool

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Any


class DeclareLaunchArgument(Action):
    """An argument of the launch file."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Any = None,
        description: Any = None,
        choices: Any = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        checked(default_value)
        self.name = name
        self.default_value = default_value
        self.description = description
        self.choices = choices

    def execute(self, context: LaunchContext) -> None:
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                raise RuntimeError(
                    f"Required launch argument '{self.name}' was not provided: give it a default_value"
                )
            context.launch_configurations[self.name] = perform(context, self.default_value)
        value = context.launch_configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {list(self.choices)}"
            )


class _Named(Action):
    """An action about something with a name."""

    def __init__(self, name: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(name)
        self.name = name


class _Valued(_Named):
    """An action about something with a name and a value."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(name, **options)
        checked(value)
        self.value = value


class SetLaunchConfiguration(_Valued):
    """Sets an argument."""

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations[perform(context, self.name)] = perform(context, self.value)


class UnsetLaunchConfiguration(_Named):
    """Takes an argument away, if it is there."""

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations.pop(perform(context, self.name), None)


class SetEnvironmentVariable(_Valued):
    """Sets an environment variable."""

    def execute(self, context: LaunchContext) -> None:
        context.environment[perform(context, self.name)] = perform(context, self.value)


class AppendEnvironmentVariable(_Valued):
    """Adds to an environment variable, at its end or before it."""

    def __init__(
        self, name: Any, value: Any, prepend: Any = False, separator: Any = os.pathsep, **options: Any
    ) -> None:
        super().__init__(name, value, **options)
        checked(separator)
        self.prepend = prepend
        self.separator = separator

    def execute(self, context: LaunchContext) -> None:
        name, parts = perform(context, self.name), [perform(context, self.value)]
        if name in context.environment:
            at = len(parts) if perform_bool(context, self.prepend) else 0
            parts.insert(at, context.environment[name])
        context.environment[name] = perform(context, self.separator).join(parts)


class UnsetEnvironmentVariable(_Named):
    """Takes an environment variable away, if it is there."""

    def execute(self, context: LaunchContext) -> None:
        context.environment.pop(perform(context, self.name), None)


class PushLaunchConfigurations(Action):
    """Remembers the arguments for PopLaunchConfigurations."""

    def execute(self, context: LaunchContext) -> None:
        context._push_launch_configurations()


class PopLaunchConfigurations(Action):
    """Takes the arguments back that were remembered last."""

    def execute(self, context: LaunchContext) -> None:
        context._pop_launch_configurations()


class ResetLaunchConfigurations(Action):
    """Takes all arguments away but those that are given, whose values may use the old ones."""

    def __init__(self, launch_configurations: Mapping[Any, Any] | None = None, **options: Any) -> None:
        super().__init__(**options)
        self._configurations = launch_configurations or {}

    def execute(self, context: LaunchContext) -> None:
        kept = {
            perform(context, name): perform(context, value) for name, value in self._configurations.items()
        }
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)


class PushEnvironment(Action):
    """Remembers the environment for PopEnvironment."""

    def execute(self, context: LaunchContext) -> None:
        context._push_environment()


class PopEnvironment(Action):
    """Takes the environment back that was remembered last."""

    def execute(self, context: LaunchContext) -> None:
        context._pop_environment()


class ResetEnvironment(Action):
    """Takes the environment back that there was before the launch file."""

    def execute(self, context: LaunchContext) -> None:
        context._reset_environment()


class GroupAction(Action):
    """Several actions; what they change of arguments and environment ends with them.

    Args:
        scoped: whether it does end.
        forwarding: whether they begin with what holds around them; False: with `launch_configurations` alone.
    """

    def __init__(
        self,
        actions: Iterable[Any],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        configurations = launch_configurations or {}
        entities = list(actions)
        if forwarding or not scoped:
            entities[:0] = [SetLaunchConfiguration(name, value) for name, value in configurations.items()]
        else:
            entities[:0] = [ResetEnvironment(), ResetLaunchConfigurations(configurations)]
        if scoped:
            entities = [PushLaunchConfigurations(), PushEnvironment(), *entities]
            entities += [PopEnvironment(), PopLaunchConfigurations()]
        self._entities = entities

    def get_sub_entities(self) -> list[Any]:
        """Return what it does, in order."""
        return self._entities

    def execute(self, context: LaunchContext) -> list[Any]:
        return self._entities
