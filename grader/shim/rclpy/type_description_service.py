"""The service through which others learn what a node's types consist of."""

from __future__ import annotations

from _weakref import ref

from rclpy._interfaces.own import LazyType
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_services_default
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"


class TypeDescriptionService:
    """Creates and answers ``~/get_type_description``, unless a parameter of the node says otherwise."""

    def __init__(self, node: Any) -> None:
        self._node_weak_ref = ref(node)
        self.service_name = TOPIC_SEPARATOR_STRING.join((node.get_name(), "get_type_description"))
        self._type_description_srv: Any = None
        name = START_TYPE_DESCRIPTION_SERVICE_PARAM
        if not node.has_parameter(name):
            from rclpy._interfaces.own import ParameterDescriptor

            descriptor = ParameterDescriptor(
                name=name,
                type=Parameter.Type.BOOL.value,
                description="If enabled, start the ~/get_type_description service.",
                read_only=True,
            )
            node.declare_parameter(name, True, descriptor)
        parameter = node.get_parameter(name)
        self.enabled = bool(parameter.type_ == Parameter.Type.BOOL and parameter.value)
        if parameter.type_ not in (Parameter.Type.BOOL, Parameter.Type.NOT_SET):
            text = f"Invalid type for parameter '{name}' {parameter.type_!r} should be bool"
            node.get_logger().error(text)
        if self.enabled:
            lazy = LazyType("type_description_interfaces/srv/GetTypeDescription")
            self._type_description_srv = node._rcl_add_service(
                lazy, self.service_name, self._service_callback, qos_profile_services_default, None
            )

    def destroy(self) -> None:
        """Forget the service, which goes with its node."""
        self._type_description_srv = None

    def _service_callback(self, request: Any, response: Any) -> Any:
        from rclpy._jazzy.descriptions import describe, hash_of

        try:
            description = describe(request.type_name)
        except (KeyError, ValueError):
            response.failure_reason = f"Type '{request.type_name}' not currently in use by this node"
            return response
        if request.type_hash and request.type_hash != str(hash_of(request.type_name)):
            response.failure_reason = f"Type hash '{request.type_hash}' is not that of '{request.type_name}'"
            return response
        from rosidl_runtime_py.set_message import set_message_fields

        set_message_fields(response.type_description, description)
        response.successful = True
        return response
