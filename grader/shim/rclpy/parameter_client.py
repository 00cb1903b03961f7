"""Reading and setting the parameters of other nodes."""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from rclpy.callback_groups import CallbackGroup
    from rclpy.node import Node
    from rclpy.subscription import Subscription
    from rclpy.task import Future

    Done = Callable[[Future], Any]

_POLL_NS = 250_000_000
_SERVICES = (
    ("_list_parameter_client", "ListParameters", "list_parameters"),
    ("_set_parameter_client", "SetParameters", "set_parameters"),
    ("_get_parameter_client", "GetParameters", "get_parameters"),
    ("_get_parameter_types_client", "GetParameterTypes", "get_parameter_types"),
    ("_describe_parameters_client", "DescribeParameters", "describe_parameters"),
    ("_set_parameters_atomically_client", "SetParametersAtomically", "set_parameters_atomically"),
)


class AsyncParameterClient:
    """Calls the parameter services of another node; each method returns the future of the response."""

    _list_parameter_client: Any
    _set_parameter_client: Any
    _get_parameter_client: Any
    _get_parameter_types_client: Any
    _describe_parameters_client: Any
    _set_parameters_atomically_client: Any

    def __init__(
        self,
        node: Node,
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        import rcl_interfaces.srv

        self.remote_node_name = remote_node_name
        self.node = node
        for attribute, kind, name in _SERVICES:
            created = node.create_client(
                getattr(rcl_interfaces.srv, kind),
                f"{remote_node_name}/{name}",
                qos_profile=qos_profile,
                callback_group=callback_group,
            )
            setattr(self, attribute, created)

    def services_are_ready(self) -> bool:
        """Whether all six services exist."""
        return all(getattr(self, attribute).service_is_ready() for attribute, *_ in _SERVICES)

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait in steps of 0.25 s until all services exist; whether they do at the end."""
        left_s = float("inf") if timeout_sec is None else timeout_sec
        while not self.services_are_ready() and left_s > 0.0:
            kernel.sleep_ns(_POLL_NS)
            left_s -= _POLL_NS / 1e9
        return self.services_are_ready()

    def list_parameters(
        self, prefixes: list[str] | None = None, depth: int | None = None, callback: Done | None = None
    ) -> Future:
        """Ask for the names that begin with one of the prefixes, down to a depth."""
        fields: dict[str, Any] = {"prefixes": prefixes, "depth": depth}
        values = {name: value for name, value in fields.items() if value}
        return self._call(self._list_parameter_client, callback, **values)

    def get_parameters(self, names: list[str], callback: Done | None = None) -> Future:
        """Ask for values."""
        return self._call(self._get_parameter_client, callback, names=names)

    def set_parameters(self, parameters: Sequence[Any], callback: Done | None = None) -> Future:
        """Set parameters, given as `Parameter` or message, one by one."""
        return self._call(self._set_parameter_client, callback, parameters=_messages(parameters))

    def describe_parameters(self, names: list[str], callback: Done | None = None) -> Future:
        """Ask for descriptors."""
        return self._call(self._describe_parameters_client, callback, names=names)

    def get_parameter_types(self, names: list[str], callback: Done | None = None) -> Future:
        """Ask for types."""
        return self._call(self._get_parameter_types_client, callback, names=names)

    def set_parameters_atomically(self, parameters: Sequence[Any], callback: Done | None = None) -> Future:
        """Set all parameters or none."""
        client = self._set_parameters_atomically_client
        return self._call(client, callback, parameters=_messages(parameters))

    def delete_parameters(self, names: list[str], callback: Done | None = None) -> Future:
        """Unset parameters, which must be typed dynamically."""
        return self.set_parameters([Parameter(name=name) for name in names], callback)

    def load_parameter_file(
        self, parameter_file: str, use_wildcard: bool = False, callback: Done | None = None
    ) -> Future:
        """Set the parameters of a YAML file one by one."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters(list(parameters.values()), callback)

    def load_parameter_file_atomically(
        self, parameter_file: str, use_wildcard: bool = False, callback: Done | None = None
    ) -> Future:
        """Set all parameters of a YAML file or none."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters_atomically(list(parameters.values()), callback)

    def on_parameter_event(
        self,
        callback: Callable[[Any], Any],
        qos_profile: QoSProfile = qos_profile_parameter_events,
        **options: Any,
    ) -> Subscription:
        """Have `callback` called with each change of a parameter of any node; `options` as of a subscription."""
        from rcl_interfaces.msg import ParameterEvent

        topic = "/parameter_events"
        return self.node.create_subscription(ParameterEvent, topic, callback, qos_profile, **options)

    @staticmethod
    def _call(client: Any, callback: Done | None, **fields: Any) -> Future:
        request = client.srv_type.Request()
        for name, value in fields.items():
            setattr(request, name, value)
        future: Future = client.call_async(request)
        if callback:
            future.add_done_callback(callback)
        return future


def _messages(parameters: Sequence[Any]) -> list[Any]:
    return [given.to_parameter_msg() if isinstance(given, Parameter) else given for given in parameters]
