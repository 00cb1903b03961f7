"""Nodes. Their command lines are as launch_ros 0.19 (Humble) writes them."""

from __future__ import annotations

import os
import sys

from launch._evaluation import Action, LaunchContext, Substitution, checked, perform
from launch._types import yaml
from launch.actions import ExecuteProcess
from launch.substitutions import CommandNotRunError
from rclpy import _distro
from rclpy._process.packages import workspace
from rclpy.validate_namespace import validate_namespace

from launch_ros._parameters import evaluate_parameter_dict, normalize_parameters
from launch_ros.parameter_descriptions import Parameter, ParameterFile, new_file

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
        command = [program, *(arguments or ()), *(["--ros-args", *ros_arguments] if ros_arguments else ())]
        super().__init__(cmd=[*command, "--ros-args"], **{**options, "name": exec_name})
        self.node_package = package
        self.node_executable = executable
        self.expanded_node_namespace = self.UNSPECIFIED_NODE_NAMESPACE
        self.expanded_remapping_rules: list[tuple[str, str]] | None = None
        self._name = name
        self._namespace = namespace
        self._remappings = [(source, target) for source, target in remappings or ()]
        self._full_name: str | None = None
        if parameters is not None and not isinstance(parameters, list):
            raise TypeError(
                f"'Node' expected 'parameters' to be one of [{list}], but got '{parameters}' of type "
                f"'{type(parameters)}': write parameters=[...]"
            )
        self._parameters = normalize_parameters(parameters or ())

    @property
    def node_name(self) -> str:
        """The name with the namespace in front. Raises RuntimeError: it has not been started."""
        if self._full_name is None:
            raise RuntimeError("cannot access 'node_name' before executing action")
        return self._full_name

    def is_node_name_fully_specified(self) -> bool:
        """Return whether the launch file says both name and namespace."""
        return not any(
            unspecified in self.node_name
            for unspecified in (self.UNSPECIFIED_NODE_NAME, self.UNSPECIFIED_NODE_NAMESPACE)
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
        arguments = []
        name = self.UNSPECIFIED_NODE_NAME
        if self._name is not None:
            name = perform(context, self._name)
            arguments += ["-r", f"__node:={name}"]
        own = None if self._namespace is None else perform(context, self._namespace)
        namespace = joined_namespace(context.launch_configurations.get("ros_namespace"), own)
        if namespace is not None:
            self.expanded_node_namespace = namespace
            arguments += ["-r", f"__ns:={namespace}"]
            validate_namespace(namespace)
        self._full_name = f"{self.expanded_node_namespace.rstrip('/')}/{name}"
        node = self._full_name if self.is_node_name_fully_specified() else "/**"
        configurations = context.launch_configurations
        for entry in configurations.get("global_params", ()):
            if isinstance(entry, tuple):  # by SetParameter
                arguments += ["-p", f"{entry[0]}:={entry[1]}"]
            else:
                arguments += ["--params-file", os.path.abspath(entry)]
        for entry in self._parameters:
            arguments += _parameter_arguments(context, entry, node)
        rules = list(configurations.get("ros_remaps", ()))
        rules += [(perform(context, source), perform(context, target)) for source, target in self._remappings]
        self.expanded_remapping_rules = rules or None
        return arguments + [word for source, target in rules for word in ("-r", f"{source}:={target}")]


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
        for description in self._descriptions:
            if description.condition() is None or description.condition().evaluate(context):
                plugin = perform(context, description.node_plugin)
                context.untold.append(f"the component {plugin} of {perform(context, description.package)}")


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


def _parameter_arguments(context: LaunchContext, given: Any, node: str) -> list[str]:
    """Return the arguments for one of `parameters=`; of a dictionary, a file that is written for `node`."""
    if isinstance(given, Parameter):
        name, value = given.evaluate(context)
        return ["-p", f"{name}:={yaml().dump(value)}"]
    if isinstance(given, ParameterFile):
        path = str(given.evaluate(context))
    else:
        values = evaluate_parameter_dict(context, given)
        path = new_file(yaml().dump({node: {"ros__parameters": values}}, default_flow_style=False))
    if os.path.isfile(path):
        return ["--params-file", path]
    sys.stderr.write(f"[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: {path}\n")
    return []
