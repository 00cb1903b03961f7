"""The services through which others read and set a node's parameters."""

from __future__ import annotations

from _weakref import ref

from rclpy._forwarding import passed_on
from rclpy._interfaces.own import LazyType
from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.qos import qos_profile_parameters
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__getattr__ = passed_on(__name__)


class ParameterService:
    """Creates and answers the six parameter services of a node."""

    def __init__(self, node: Any) -> None:
        self._node_weak_ref = ref(node)
        for name, kind, callback in (
            ("describe_parameters", "DescribeParameters", self._describe_parameters_callback),
            ("get_parameters", "GetParameters", self._get_parameters_callback),
            ("get_parameter_types", "GetParameterTypes", self._get_parameter_types_callback),
            ("list_parameters", "ListParameters", self._list_parameters_callback),
            ("set_parameters", "SetParameters", self._set_parameters_callback),
            (
                "set_parameters_atomically",
                "SetParametersAtomically",
                self._set_parameters_atomically_callback,
            ),
        ):
            full_name = TOPIC_SEPARATOR_STRING.join((node.get_name(), name))
            lazy = LazyType(f"rcl_interfaces/srv/{kind}")
            node._rcl_add_own_service(lazy, full_name, callback, qos_profile_parameters)

    def _describe_parameters_callback(self, request: Any, response: Any) -> Any:
        node = self._get_node()
        try:
            response.descriptors = [node.describe_parameter(name) for name in request.names]
        except ParameterNotDeclaredException:
            response.descriptors = []
        return response

    def _get_parameters_callback(self, request: Any, response: Any) -> Any:
        node = self._get_node()
        try:
            response.values = [node.get_parameter(name).get_parameter_value() for name in request.names]
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            response.values = []
        return response

    def _get_parameter_types_callback(self, request: Any, response: Any) -> Any:
        node = self._get_node()
        try:
            response.types = [node.get_parameter_type(name) for name in request.names]
        except ParameterNotDeclaredException:
            response.types = []
        return response

    def _list_parameters_callback(self, request: Any, response: Any) -> Any:
        """List names up to `request.depth` levels; upstream's order: top-level names first."""
        separator = PARAMETER_SEPARATOR_STRING
        result = response.result
        nested = []
        for name in self._get_node()._parameters:
            if separator in name:
                nested.append(name)
            elif not request.prefixes:
                result.names.append(name)
            else:
                result.names.extend(name for prefix in request.prefixes if name.startswith(prefix))
        if request.depth == 1:
            return response
        for name in nested:
            if request.depth != request.DEPTH_RECURSIVE and name.count(separator) >= request.depth:
                continue
            parent = name.rpartition(separator)[0]
            if not request.prefixes:
                _add(result.prefixes, parent)
                result.names.append(name)
            for prefix in request.prefixes:
                if name.startswith(prefix + separator):
                    result.names.append(name)
                    _add(result.prefixes, parent)
                    _add(result.prefixes, prefix)
        return response

    def _set_parameters_callback(self, request: Any, response: Any) -> Any:
        for message in request.parameters:
            response.results.append(self._set([message]))
        return response

    def _set_parameters_atomically_callback(self, request: Any, response: Any) -> Any:
        response.result = self._set(request.parameters)
        return response

    def _set(self, messages: list[Any]) -> Any:
        from rclpy._interfaces.own import SetParametersResult

        try:
            return self._get_node().set_parameters_atomically(
                [Parameter.from_parameter_msg(message) for message in messages]
            )
        except ParameterNotDeclaredException as error:
            return SetParametersResult(successful=False, reason=str(error))

    def _get_node(self) -> Any:
        node = self._node_weak_ref()
        if node is None:
            raise ReferenceError("Expected valid node weak reference")
        return node


def _add(names: list[str], name: str) -> None:
    if name not in names:
        names.append(name)
