"""Nodes. Their command lines are as launch_ros 0.19 (Humble) writes them."""

from __future__ import annotations

import json
import os
import sys

from launch._evaluation import Action, LaunchContext, Substitution, checked, perform, perform_bool
from launch.actions import ExecuteProcess
from launch.substitutions import CommandNotRunError
from rclpy import _distro
from rclpy._process.packages import workspace
from rclpy.validate_namespace import validate_namespace

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any


class Node(ExecuteProcess):
    """A node: an executable of a package, with names, parameters and remappings.

    `additional_env`, `env` and `cwd` hold for its program; with `package` left out it is a command.
    """

    UNSPECIFIED_NODE_NAME = "<node_name_unspecified>"
    UNSPECIFIED_NODE_NAMESPACE = "<node_namespace_unspecified>"

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
        ros_arguments: Any = None,
        arguments: Any = None,
        **options: Any,
    ) -> None:
        checked(package, executable, name, namespace)
        program = executable if package is None else _Program(package, executable)
        given = [program, *(arguments or ()), *(["--ros-args", *ros_arguments] if ros_arguments else ())]
        super().__init__(cmd=[*given, "--ros-args"], **{**options, "name": exec_name})
        self.node_package = package
        self.node_executable = executable
        self.expanded_node_namespace = self.UNSPECIFIED_NODE_NAMESPACE
        self.expanded_remapping_rules: list[tuple[str, str]] | None = None
        self._name = name
        self._namespace = namespace
        self._parameters = parameters or ()
        self._remappings = [(source, target) for source, target in remappings or ()]
        self._full_name: str | None = None
        if parameters is not None and not isinstance(parameters, list):
            raise TypeError(
                f"'Node' expected 'parameters' to be one of [{list}], but got '{parameters}' of type "
                f"'{type(parameters)}': write parameters=[...]"
            )

    @property
    def node_name(self) -> str:
        """The name with the namespace in front.

        Raises:
            RuntimeError: it has not been started.
        """
        if self._full_name is None:
            raise RuntimeError("cannot access 'node_name' before executing action")
        return self._full_name

    def is_node_name_fully_specified(self) -> bool:
        """Return whether the launch file says both name and namespace."""
        return not any(
            each in self.node_name for each in (self.UNSPECIFIED_NODE_NAME, self.UNSPECIFIED_NODE_NAMESPACE)
        )

    def execute_in(self, context: LaunchContext) -> None:
        package = "" if self.node_package is None else perform(context, self.node_package)
        executable = perform(context, self.node_executable)
        try:
            self.process_description.cmd += self._of_ros(context)
            self.begin(context)
        except CommandNotRunError as error:
            if package in workspace.names:
                raise
            context.untold.append(f"{package} {executable}: {error}")
            return
        context.started.append((self, "node", Started(self, package, executable, context.delay_s)))

    def _of_ros(self, context: LaunchContext) -> list[str]:
        """Return what stands behind the last ``--ros-args``."""
        found = []
        name = self.UNSPECIFIED_NODE_NAME
        if self._name is not None:
            name = perform(context, self._name)
            found += ["-r", f"__node:={name}"]
        own = None if self._namespace is None else perform(context, self._namespace)
        namespace = joined_namespace(context.launch_configurations.get("ros_namespace"), own)
        if namespace is not None:
            self.expanded_node_namespace = namespace
            found += ["-r", f"__ns:={namespace}"]
            validate_namespace(namespace)
        self._full_name = f"{self.expanded_node_namespace.rstrip('/')}/{name}"
        node = self._full_name if self.is_node_name_fully_specified() else "/**"
        given = context.launch_configurations
        for each in (*given.get("global_params", ()), *self._parameters):
            given_alone = isinstance(each, tuple)  # by SetParameter, as -p for whatever node there is
            path = _parameter_file(
                context, dict([each]) if given_alone else each, "/**" if given_alone else node
            )
            if os.path.isfile(path):
                found += ["--params-file", path]
            else:
                sys.stderr.write(
                    f"[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: {path}\n"
                )
        rules = list(given.get("ros_remaps", ()))
        rules += [(perform(context, source), perform(context, target)) for source, target in self._remappings]
        self.expanded_remapping_rules = rules or None
        return found + [word for source, target in rules for word in ("-r", f"{source}:={target}")]


class _Program(Substitution):
    """Where the program of a node would be; whether it is there, is looked up when it starts."""

    def __init__(self, package: Any, executable: Any) -> None:
        self.package = package
        self.executable = executable

    def perform(self, context: LaunchContext) -> str:
        package, executable = perform(context, self.package), perform(context, self.executable)
        prefix = workspace.prefix_of(package) or f"/opt/ros/{_distro.chosen}"
        return f"{prefix}/lib/{package}/{executable}"


class Started:
    """A node that would have been started.

    Attributes:
        arguments: its command line without the program.
        environment, cwd: what holds for its program; of `cwd` None: the launch's.
        untold: what the launch file says of it that is not carried out.
    """

    def __init__(self, action: Node, package: str, executable: str, delay_s: float) -> None:
        described = action.process_description
        cmd = described.final_cmd or []
        at = next((at for at, word in enumerate(cmd) if word.endswith(f"/{executable}")), 0)
        self.action = action
        self.package = package
        self.executable = executable
        self.arguments = cmd[at + 1 :]
        self.delay_s = delay_s
        self.environment = described.final_env or {}
        self.cwd = described.final_cwd
        self.untold = [*action.untold(), *(["prefix " + " ".join(cmd[:at])] if at else [])]


class LifecycleNode(Node):
    """A node with states, which needs name and namespace. Events about its states never come here."""

    def __init__(self, *, name: Any, namespace: Any, **options: Any) -> None:
        super().__init__(name=name, namespace=namespace, **options)


class ComposableNodeContainer(Node):
    """A program of rclcpp that loads nodes of C++: none of it is there, and the author is told so."""

    def __init__(
        self, *, name: Any, namespace: Any, composable_node_descriptions: Any = None, **options: Any
    ) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        self._descriptions = composable_node_descriptions or ()

    def execute_in(self, context: LaunchContext) -> None:
        super().execute_in(context)
        LoadComposableNodes(composable_node_descriptions=self._descriptions, target_container=self).execute(
            context
        )


class LoadComposableNodes(Action):
    """Nodes of C++ for a container: the author is told that they are not there."""

    def __init__(
        self, *, composable_node_descriptions: Iterable[Any], target_container: Any, **options: Any
    ) -> None:
        super().__init__(**options)
        if not isinstance(target_container, ComposableNodeContainer):
            checked(target_container)
        self._descriptions = composable_node_descriptions

    def execute(self, context: LaunchContext) -> None:
        for each in self._descriptions:
            if each.condition() is None or each.condition().evaluate(context):
                plugin = perform(context, each.node_plugin)
                context.untold.append(f"the component {plugin} of {perform(context, each.package)}")


def joined_namespace(base: str | None, own: str | None) -> str | None:
    """Return a namespace behind another one, absolute; None where neither is given. One that is absolute stays."""
    if own is None and base is None:
        return None
    joined = (
        (own if own.startswith("/") or not base else f"{base.rstrip('/')}/{own}") if own is not None else base
    )
    assert joined is not None
    joined = joined if joined == "/" else joined.rstrip("/")
    return joined if joined.startswith("/") else f"/{joined}"


def _parameter_file(context: LaunchContext, given: Any, node: str) -> str:
    """Return the path of a file of parameters; of a dictionary one that is written for it and `node`."""
    if isinstance(given, ParameterFile):
        given = given.param_file
    if isinstance(given, Parameter):
        given = {given.name: ParameterValue(given.value, value_type=given.value_type)}
    if not isinstance(given, dict):
        return perform(context, given)
    path = f"/tmp/launch_params_{len(_written)}"  # noqa: S108 - the storage's own
    _written.append(path)
    lines = [f"    {name}: {_value(context, value)}\n" for name, value in _flat(context, given)]
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"{node}:\n  ros__parameters:\n" + "".join(lines))
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
        return _typed(context, value.value, value.value_type)
    if isinstance(value, Substitution):
        return perform(context, value) or '""'
    if isinstance(value, (list, tuple)):
        if any(isinstance(each, Substitution) for each in value):
            return perform(context, value)
        return "[" + ", ".join(_scalar(each) for each in value) + "]"
    return _scalar(value)


def _typed(context: LaunchContext, value: Any, kind: Any) -> str:
    """Return a value in YAML, of a text as what `kind` says; None: as YAML says, as of lists."""
    if isinstance(value, (bool, int, float)) or kind not in (str, int, float, bool):
        return _value(context, value)
    text = perform(context, value)
    if kind is bool:
        return _scalar(perform_bool(context, text))
    return json.dumps(text) if kind is str else _scalar(kind(text))


def _scalar(value: Any) -> str:
    if isinstance(value, float):
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    if isinstance(value, (bool, int, str)):
        return json.dumps(value)
    raise TypeError(f"Expected a value of a parameter, got {value!r}")
