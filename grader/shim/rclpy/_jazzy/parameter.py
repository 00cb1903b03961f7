"""Values from YAML, the rules of declaring, and the services of parameters."""

from __future__ import annotations

from importlib import import_module

from rclpy import parameter, parameter_service, time_source
from rclpy._jazzy.overlay import extends, replace
from rclpy._rcl import parameter_rules
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.validate_parameter_name import validate_parameter_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

_YAML = "yaml"  # the one package besides numpy that scripts can import, which reads it here as at home
_WITHOUT_VALUE = "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
_LISTS = ((bool, "bool"), (int, "integer"), (float, "double"), (str, "string"))


def get_parameter_value(string_value: str) -> Any:
    """Return the rcl_interfaces/msg/ParameterValue that a text stands for when it is read as YAML."""
    from rcl_interfaces.msg import ParameterType, ParameterValue

    yaml = import_module(_YAML)
    try:
        value: Any = yaml.safe_load(string_value)
    except yaml.parser.ParserError:
        value = string_value
    message = ParameterValue()
    for scalar, name in _LISTS[:3]:
        if isinstance(value, scalar):
            message.type = getattr(ParameterType, f"PARAMETER_{name.upper()}")
            setattr(message, f"{name}_value", value)
            return message
    if isinstance(value, list):
        for kind, name in _LISTS:
            if all(isinstance(element, kind) for element in value):
                message.type = getattr(ParameterType, f"PARAMETER_{name.upper()}_ARRAY")
                setattr(message, f"{name}_array_value", value)
                return message
        value = string_value
    message.type = ParameterType.PARAMETER_STRING
    message.string_value = string_value if value is None else value
    return message


def parameter_dict_from_yaml_file(
    parameter_file: str,
    use_wildcard: bool = False,
    target_nodes: list[str] | None = None,
    namespace: str = "",
) -> dict[str, Any]:
    """Return the rcl_interfaces/msg/Parameter messages of a parameter file by name.

    Raises RuntimeError: a node of `target_nodes` is not in it, none is, or it is no parameter file.
    """
    with open(parameter_file) as file:
        content = import_module(_YAML).safe_load(file)
    keys = ["/**"] if use_wildcard and "/**" in content else []
    if target_nodes:
        for node in target_nodes:
            if node not in content:
                raise RuntimeError(
                    f"Param file does not contain parameters for {node},only for nodes: {list(content)} "
                )
            keys.append(node)
    else:
        keys.extend(name for name in content if name != "/**")
    if not keys:
        raise RuntimeError("Param file does not contain selected parameters")
    nested: dict[str, Any] = {}
    for node in keys:
        value = content[node]
        if not isinstance(value, dict) or "ros__parameters" not in value:
            raise RuntimeError(f"YAML file is not a valid ROS parameter file for node {node}")
        nested.update(value["ros__parameters"])
    return _unpack_parameter_dict(namespace, nested)


def _unpack_parameter_dict(namespace: str, parameter_dict: dict[str, Any]) -> dict[str, Any]:
    """Return the messages of nested values by their full names."""
    from rcl_interfaces.msg import Parameter as ParameterMsg

    messages: dict[str, Any] = {}
    for key, value in parameter_dict.items():
        name = namespace + key
        if isinstance(value, dict):
            messages.update(_unpack_parameter_dict(name + PARAMETER_SEPARATOR_STRING, value))
        else:
            messages[name] = ParameterMsg(name=name, value=get_parameter_value(str(value)))
    return messages


def named_declaration(
    index: int, entry: tuple[Any, ...], namespace: str, overrides: Mapping[str, Parameter]
) -> tuple[str, Any, Any]:
    """Return name, value and descriptor of one entry given to `declare_parameters`.

    Raises:
        TypeError, ValueError: the entry is malformed. InvalidParameterException: the name is empty.
    """
    name, second, descriptor = parameter_rules._taken_apart(index, entry)
    if namespace:
        name = f"{namespace}.{name}"
    validate_parameter_name(name)
    value = None
    if isinstance(second, Parameter.Type):
        parameter_rules._note_type(name, second, descriptor)
    else:
        value = second
        if not descriptor.dynamic_typing:
            if value is None:
                raise ValueError(_WITHOUT_VALUE)
            descriptor.type = parameter_rules._type_of_default(value)
    if name in overrides:
        value = overrides[name].value
    return name, value, descriptor


@extends(parameter_service.ParameterService)
class ParameterService(parameter_service.ParameterService):
    """Creates and answers the six parameter services of a node."""

    def _list_parameters_callback(self, request: Any, response: Any) -> Any:
        response.result = self._get_node().list_parameters(request.prefixes, request.depth)
        return response


@extends(time_source.TimeSource)
class TimeSource(time_source.TimeSource):
    """Drives ROS clocks for a node; refuses a `use_sim_time` that is no truth value."""

    def _on_parameter_event(self, parameter_list: list[Parameter]) -> Any:
        from rclpy._interfaces.own import SetParametersResult

        for changed in parameter_list:
            if changed.name != time_source.USE_SIM_TIME_NAME:
                continue
            if changed.type_ == Parameter.Type.BOOL:
                self.ros_time_is_active = changed.value
                break
            reason = f"{time_source.USE_SIM_TIME_NAME} parameter set to something besides a bool"
            node = self._get_node()
            if node:
                node.get_logger().error(reason)
            return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)


replace(parameter_rules, named_declaration=named_declaration)
replace(
    parameter,
    get_parameter_value=get_parameter_value,
    parameter_dict_from_yaml_file=parameter_dict_from_yaml_file,
    _unpack_parameter_dict=_unpack_parameter_dict,
)
