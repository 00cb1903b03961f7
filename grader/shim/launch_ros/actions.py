"""Nodes, and what holds for all nodes behind an action. Command lines as launch_ros 0.19 (Humble) writes them."""

from __future__ import annotations

import json
import os
import sys

from launch._evaluation import Action, LaunchContext, Substitution, checked, perform
from launch.actions import ExecuteProcess

from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Node(ExecuteProcess):
    """A node: an executable of a package, with names, parameters and remappings."""

    def __init__(
        self,
        *,
        executable: Any,
        package: Any = None,
        name: Any = None,
        namespace: Any = None,
        exec_name: Any = None,
        parameters: Any = None,
        remappings: Any = None,
        arguments: Any = None,
        ros_arguments: Any = None,
        **options: Any,
    ) -> None:
        super().__init__(cmd=[executable, *(arguments or ()), *(ros_arguments or ())], **options)
        checked(package, name, namespace)
        self.package = package
        self.executable = executable
        self.name = name
        self.namespace = namespace
        self.parameters = parameters or ()
        self.remappings = remappings or ()
        self.arguments = arguments or ()
        self.ros_arguments = ros_arguments or ()
        if isinstance(self.parameters, (dict, str)):
            raise TypeError("parameters must be a list of dictionaries and paths: write parameters=[...]")

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        self.begin(context)
        package = "" if self.package is None else perform(context, self.package)
        executable = perform(context, self.executable)
        started = Started(self, package, executable, self._arguments(context), context.delay_s)
        started.untold += self.untold
        context.started.append((self, "node", started))

    def _arguments(self, context: LaunchContext) -> list[str]:
        found = [perform(context, each) for each in self.arguments] + ["--ros-args"]
        found += [perform(context, each) for each in self.ros_arguments]
        if self.name is not None:
            found += ["-r", f"__node:={perform(context, self.name)}"]
        namespace = _namespace(context, "" if self.namespace is None else perform(context, self.namespace))
        if namespace:
            found += ["-r", f"__ns:={namespace}"]
        for each in (*context.parameters, *self.parameters):
            path = _parameter_file(context, each)
            if os.path.isfile(path):
                found += ["--params-file", path]
            else:
                sys.stderr.write(
                    f"[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: {path}\n"
                )
        for source, target in self.remappings:
            found += ["-r", f"{perform(context, source)}:={perform(context, target)}"]
        return found


class Started:
    """A node that would have been started.

    Attributes:
        untold: what the launch file says of it that is not carried out.
    """

    def __init__(
        self, action: Node, package: str, executable: str, arguments: list[str], delay_s: float
    ) -> None:
        self.action = action
        self.package = package
        self.executable = executable
        self.arguments = arguments
        self.delay_s = delay_s
        self.untold: list[str] = []


class PushRosNamespace(Action):
    """A namespace for the nodes behind it."""

    def __init__(self, namespace: Any, **options: Any) -> None:
        super().__init__(**options)
        self.namespace = namespace

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        context.namespaces.append(perform(context, self.namespace))


class SetParameter(Action):
    """A parameter for the nodes behind it."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(**options)
        self.name = name
        self.value = value

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        context.parameters.append({perform(context, self.name): self.value})


def _namespace(context: LaunchContext, own: str) -> str:
    if own.startswith("/"):
        return own
    parts = [part.strip("/") for part in (*context.namespaces, own) if part.strip("/")]
    return "/" + "/".join(parts) if parts else ""


def _parameter_file(context: LaunchContext, given: Any) -> str:
    """Return the path of a file of parameters; of a dictionary one that is written for it."""
    if isinstance(given, ParameterFile):
        given = given.param_file
    if not isinstance(given, dict):
        return perform(context, given)
    path = f"/tmp/launch_params_{len(_written)}"  # noqa: S108 - the storage's own
    _written.append(path)
    lines = [f"    {name}: {_value(context, value)}\n" for name, value in _flat(context, given)]
    with open(path, "w", encoding="utf-8") as file:
        file.write("/**:\n  ros__parameters:\n" + "".join(lines))
    return path


_written: list[str] = []


def _flat(context: LaunchContext, given: dict[Any, Any], before: str = "") -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for key, value in given.items():
        name = before + perform(context, key)
        found += _flat(context, value, f"{name}.") if isinstance(value, dict) else [(name, value)]
    return found


def _value(context: LaunchContext, value: Any) -> str:
    """Return a value in YAML; the text of a substitution is read as YAML, as upstream does."""
    if isinstance(value, ParameterValue):
        text = value.value if isinstance(value.value, (bool, int, float)) else perform(context, value.value)
        return json.dumps(text) if value.value_type is str else _scalar(value.value_type(text))
    if isinstance(value, Substitution):
        return perform(context, value) or '""'
    if isinstance(value, (list, tuple)):
        if any(isinstance(each, Substitution) for each in value):
            return perform(context, value)
        return "[" + ", ".join(_scalar(each) for each in value) + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if isinstance(value, float):
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    if isinstance(value, (bool, int, str)):
        return json.dumps(value)
    raise TypeError(f"Expected a value of a parameter, got {value!r}")
