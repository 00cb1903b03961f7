"""Texts that are known when a description is evaluated."""

from __future__ import annotations

import math
import os

from launch._evaluation import LaunchContext, Substitution, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class SubstitutionFailure(RuntimeError):
    """A substitution has no text."""


class TextSubstitution(Substitution):
    """A text as it is."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        return self.text


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: Any, *, default: Any = None) -> None:
        self.variable_name = variable_name
        self.default = default

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.variable_name)
        if name in context.launch_configurations:
            return context.launch_configurations[name]
        if self.default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        default = self.default
        return perform(context, default if isinstance(default, (str, Substitution, list)) else str(default))


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined."""

    def __init__(self, substitutions: Any) -> None:
        self.substitutions = substitutions

    def perform(self, context: LaunchContext) -> str:
        return os.path.join(*(perform(context, each) for each in self.substitutions))


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: Any, *, default_value: Any = None) -> None:
        self.name = name
        self.default_value = default_value

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.name)
        if name in context.environment:
            return str(context.environment[name])
        if self.default_value is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return perform(context, self.default_value)


class PythonExpression(Substitution):
    """The value of an expression, as text."""

    def __init__(self, expression: Any, python_modules: Any = ()) -> None:
        self.expression = expression

    def perform(self, context: LaunchContext) -> str:
        return str(eval(perform(context, self.expression), {}, dict(math.__dict__)))  # noqa: S307 - in the jail


class ThisLaunchFile(Substitution):
    """The path of the launch file under way."""

    def perform(self, context: LaunchContext) -> str:
        return context.files[-1]


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file under way."""

    def perform(self, context: LaunchContext) -> str:
        return os.path.dirname(context.files[-1])


class FindExecutable(Substitution):
    """The path of a program."""

    def __init__(self, *, name: Any) -> None:
        self.name = name

    def perform(self, context: LaunchContext) -> str:
        return f"/usr/bin/{perform(context, self.name)}"
