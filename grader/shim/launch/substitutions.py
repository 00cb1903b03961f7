"""Texts that are known when a description is evaluated. Some are Jazzy's only."""

from __future__ import annotations

import math
import os
import sys

from rclpy import _distro

from launch._evaluation import LaunchContext, Substitution, checked, perform, perform_bool

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class SubstitutionFailure(RuntimeError):
    """A substitution has no text."""


class TextSubstitution(Substitution):
    """A text as it is."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected Text object got '{type(text)}' instead.")
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
            return str(context.launch_configurations[name])
        if self.default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        default = self.default
        return perform(context, default if isinstance(default, (str, Substitution, list)) else str(default))


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined."""

    def __init__(self, substitutions: Any) -> None:
        self.substitutions = substitutions

    def perform(self, context: LaunchContext) -> str:
        return os.path.join(*(perform(context, substitution) for substitution in self.substitutions))


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
    """The value of an expression, as text.

    The names of `math` can be used in it. On Jazzy modules can be named, which `math` is then no more among.
    """

    def __init__(self, expression: Any) -> None:
        checked(expression)
        self.expression = expression
        self.python_modules: Any = ["math"]

    def perform(self, context: LaunchContext) -> str:
        from importlib import import_module

        names = self.python_modules
        known: dict[str, Any] = {}
        for part in [names] if isinstance(names, (str, Substitution)) else names:
            module = import_module(perform(context, part))
            if module is math:
                known.update(vars(math))
            if _distro.chosen == _distro.JAZZY:
                known[module.__name__] = module
        return str(eval(perform(context, self.expression), {}, known))  # noqa: S307 - in the jail


def _jazzy_init(self: PythonExpression, expression: Any, python_modules: Any = ("math",)) -> None:
    checked(expression, python_modules)
    self.expression = expression
    self.python_modules = python_modules


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


class LocalSubstitution(Substitution):
    """What an event's handlers may look at, such as ``event.reason``."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        if not isinstance(expression, str):
            raise TypeError(
                f"'LocalSubstitution' expected 'expression' to be one of [{str}], "
                f"but got '{expression}' of type '{type(expression)}'"
            )
        self.expression = expression
        self.description = description

    def perform(self, context: LaunchContext) -> str:
        found: str = eval("context.locals." + self.expression)  # noqa: S307 - in the jail
        return found


class AnonName(Substitution):
    """A name with something behind it that no other has; the same in each run."""

    def __init__(self, name: Any) -> None:
        checked(name)
        self.name = name

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.name)
        known = context.launch_configurations
        if "anon" + name not in known:
            known["anon" + name] = self.compute_name(name)
        return str(known["anon" + name])

    @staticmethod
    def compute_name(id_value: str) -> str:
        """Return a name with host, process and a number behind it."""
        import random
        import socket

        number = random.Random(id_value).randint(0, sys.maxsize)  # noqa: S311 - not the script's own
        text = f"{id_value}_{socket.gethostname()}_{os.getpid()}_{number}"
        return text.translate(str.maketrans(".-:", "___"))


class CommandNotRunError(SubstitutionFailure):
    """No command can be run here."""


class Command(Substitution):
    """What a command prints. None can be run here."""

    def __init__(self, command: Any, *, on_stderr: Any = "fail") -> None:
        checked(command, on_stderr)
        self.command = command
        self.on_stderr = on_stderr

    def perform(self, context: LaunchContext) -> str:
        raise CommandNotRunError(f"no command can be run here: {perform(context, self.command)}")


def _holds(context: LaunchContext, value: Any) -> bool:
    try:
        return perform_bool(context, value)
    except (TypeError, ValueError) as error:
        raise SubstitutionFailure(error) from None


class NotSubstitution(Substitution):
    """``true`` where a text is false, in YAML's words for it."""

    def __init__(self, value: Any) -> None:
        checked(value)
        self.value = value

    def perform(self, context: LaunchContext) -> str:
        return str(not _holds(context, self.value)).lower()


class AndSubstitution(Substitution):
    """``true`` where both texts are true."""

    def __init__(self, left: Any, right: Any) -> None:
        checked(left, right)
        self.left = left
        self.right = right

    def perform(self, context: LaunchContext) -> str:
        left, right = _holds(context, self.left), _holds(context, self.right)
        return str(left and right).lower()


class OrSubstitution(AndSubstitution):
    """``true`` where one of two texts is true."""

    def perform(self, context: LaunchContext) -> str:
        left, right = _holds(context, self.left), _holds(context, self.right)
        return str(left or right).lower()


class AllSubstitution(Substitution):
    """``true`` where all texts are true."""

    def __init__(self, *args: Any) -> None:
        checked(*args)
        self.args = args

    def _holding(self, context: LaunchContext) -> list[bool]:
        # All of them: each may be neither true nor false.
        return [_holds(context, arg) for arg in self.args]

    def perform(self, context: LaunchContext) -> str:
        return str(all(self._holding(context))).lower()


class AnySubstitution(AllSubstitution):
    """``true`` where one text is true."""

    def perform(self, context: LaunchContext) -> str:
        return str(any(self._holding(context))).lower()


class EqualsSubstitution(Substitution):
    """``true`` where two texts are the same, or the same truth or number."""

    def __init__(self, left: Any, right: Any) -> None:
        self.left, self.right = (_as_text(operand) for operand in (left, right))

    def perform(self, context: LaunchContext) -> str:
        return str(self._same(context)).lower()

    def _same(self, context: LaunchContext) -> bool:
        texts = [perform(context, operand) for operand in (self.left, self.right)]
        if all(text.lower() in ("true", "false", "1", "0") for text in texts):
            return len({text.lower() in ("true", "1") for text in texts}) == 1
        try:
            return math.isclose(*(float(text) for text in texts))
        except ValueError:
            return texts[0] == texts[1]


class NotEqualsSubstitution(EqualsSubstitution):
    """``true`` where `EqualsSubstitution` is ``false``."""

    def perform(self, context: LaunchContext) -> str:
        return str(not self._same(context)).lower()


class IfElseSubstitution(Substitution):
    """One of two texts. Raises RuntimeError: neither is given."""

    def __init__(self, condition: Any, if_value: Any = "", else_value: Any = "") -> None:
        if if_value == else_value == "":
            raise RuntimeError("One of if_value and else_value must be specified")
        checked(condition, if_value, else_value)
        self.condition = condition
        self.if_value = if_value
        self.else_value = else_value

    def perform(self, context: LaunchContext) -> str:
        return perform(context, self.if_value if _holds(context, self.condition) else self.else_value)


class FileContent(Substitution):
    """What a file contains."""

    def __init__(self, path: Any) -> None:
        checked(path)
        self.path = path

    def perform(self, context: LaunchContext) -> str:
        path = perform(context, self.path)
        try:
            with open(path) as file:
                return file.read()
        except FileNotFoundError:
            raise SubstitutionFailure(f"File not found: {path}") from None


class LaunchLogDir(Substitution):
    """The folder of this launch's log files."""

    def perform(self, context: LaunchContext) -> str:
        from launch.logging import launch_config

        return launch_config.log_dir


def _as_text(value: Any) -> Any:
    """Return what EqualsSubstitution compares: of a bool or number its text."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (str, Substitution)):
        return value
    if isinstance(value, (list, tuple)) and any(isinstance(part, Substitution) for part in value):
        checked(value)
        return value
    return "" if value is None else str(value)


__all__ = [
    "AllSubstitution",
    "AndSubstitution",
    "AnonName",
    "AnySubstitution",
    "Command",
    "EnvironmentVariable",
    "EqualsSubstitution",
    "FileContent",
    "FindExecutable",
    "IfElseSubstitution",
    "LaunchConfiguration",
    "LaunchLogDir",
    "LocalSubstitution",
    "NotEqualsSubstitution",
    "NotSubstitution",
    "OrSubstitution",
    "PathJoinSubstitution",
    "PythonExpression",
    "SubstitutionFailure",
    "TextSubstitution",
    "ThisLaunchFile",
    "ThisLaunchFileDir",
]

if _distro.chosen == _distro.HUMBLE:
    for _name in (
        "AllSubstitution", "AnySubstitution", "EqualsSubstitution", "FileContent", "IfElseSubstitution",
        "LaunchLogDir", "NotEqualsSubstitution",
    ):  # fmt: skip
        del globals()[_name]
        __all__.remove(_name)
else:
    setattr(PythonExpression, "__init__", _jazzy_init)  # noqa: B010 - mypy takes it for a mistake
