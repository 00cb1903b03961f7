"""What actions are told: parameters, and nodes of C++ for a container."""

from __future__ import annotations

from launch._evaluation import checked
from launch._modules import offer

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["ComposableNode", "Parameter", "ParameterFile", "ParameterValue"]


class ComposableNode:
    """A node of C++ for a container, of which there is none here."""

    def __init__(
        self,
        *,
        package: Any,
        plugin: Any,
        name: Any = None,
        namespace: Any = None,
        parameters: Any = None,
        remappings: Any = None,
        extra_arguments: Any = None,
        condition: Any = None,
    ) -> None:
        checked(package, plugin, name, namespace)
        self.package = package
        self.node_plugin = plugin
        self.node_name = name
        self.node_namespace = namespace
        self.parameters = parameters
        self.remappings = remappings
        self.extra_arguments = extra_arguments
        self._condition = condition

    def condition(self) -> Any:
        """Return the condition on which it is loaded; None: always."""
        return self._condition


offer(__name__, "ComposableNode")
