"""Nodes: callbacks before and after parameters are set, more questions about the graph, more services."""

from __future__ import annotations

import rclpy
from rclpy import node
from rclpy._jazzy.descriptions import hash_of
from rclpy._jazzy.overlay import extends, replace
from rclpy._kernel import kernel
from rclpy._rcl import node_handle
from rclpy.constants import S_TO_NS
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.logging_service import LoggingService
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.type_description_service import TypeDescriptionService

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.timer import Timer
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    Callback = Callable[[list[Parameter]], Any]

_POLL_NS = 100_000_000
_NOTHING_LEFT = (
    "parameter list cannot be empty, this might be due to pre_set_parameters_callback modifying the original "
    "parameters list."
)

_humble_init = node.Node.__init__
_humble_destroy = node.Node.destroy_node
_humble_infos = node.Node._rcl_infos
_humble_set_atomically = node.Node._set_parameters_atomically
_humble_create_node = rclpy.create_node


@extends(node_handle.NodeHandle)
class NodeHandle(node_handle.NodeHandle):
    """A node in the graph."""

    def get_count_clients(self, service: str) -> int:
        """Return how many clients a service has."""
        self.require_context("Error in rcl_count_clients")
        return len(self.graph.clients.at(service))

    def get_count_services(self, service: str) -> int:
        """Return how many servers a service has."""
        self.require_context("Error in rcl_count_services")
        return len(self.graph.servers.at(service))


@extends(node.Node)
class Node(node.Node):
    """A node of the ROS graph."""

    def __init__(self, *node_name: str, enable_logger_service: bool = False, **humble: Any) -> None:
        self._pre_set_parameters_callbacks: list[Callback] = []
        self._post_set_parameters_callbacks: list[Callback] = []
        _humble_init(self, *node_name, **humble)  # which refuses what is no argument, in Python's words
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)

    @property
    def _on_set_parameters_callbacks(self) -> list[Callback]:
        return self._parameters_callbacks

    def destroy_node(self) -> None:
        """Destroy the node and what it consists of; a second time does nothing."""
        self._type_description_service.destroy()
        _humble_destroy(self)

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Have `callback` called every period (seconds), without `autostart` only after `reset`."""
        return self._rcl_add_timer(timer_period_sec, callback, callback_group, clock, autostart=autostart)

    # Parameters -----------------------------------------------------------------------------------

    def _set_parameters(
        self,
        parameter_list: list[Parameter],
        descriptors: Mapping[str, Any] | None = None,
        raise_on_failure: bool = False,
        allow_undeclared_parameters: bool = False,
    ) -> list[Any]:
        """Set parameters one by one; with `raise_on_failure` they are being declared."""
        if not raise_on_failure:
            return [self._set_parameters_atomically([parameter]) for parameter in parameter_list]
        assert descriptors is not None
        results = []
        for parameter in parameter_list:
            result = self._set_parameters_atomically([parameter], descriptors, allow_not_set_type=True)
            if not result.successful:
                if result.reason.startswith("Wrong parameter type"):
                    expected = Parameter.Type(descriptors[parameter.name].type).name
                    raise InvalidParameterTypeException(parameter, expected)
                raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
            results.append(result)
        return results

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none and return one SetParametersResult."""
        return self._set_parameters_atomically(parameter_list)

    def _set_parameters_atomically(
        self,
        parameter_list: list[Parameter],
        descriptors: Mapping[str, Any] | None = None,
        allow_not_set_type: bool = False,
    ) -> Any:
        """Ask the callbacks before, set, and tell those after; being declared, parameters are only told after."""
        if descriptors is None:
            if self._pre_set_parameters_callbacks:
                callbacks = self._pre_set_parameters_callbacks
                parameter_list = [new for callback in callbacks for new in callback(parameter_list)]
                if not parameter_list:
                    from rclpy._interfaces.own import SetParametersResult

                    return SetParametersResult(successful=False, reason=_NOTHING_LEFT)
            self._check_undeclared_parameters(parameter_list)
        result = _humble_set_atomically(self, parameter_list, descriptors, allow_not_set_type)
        if result.successful:
            for callback in self._post_set_parameters_callbacks:
                callback(parameter_list)
        return result

    def list_parameters(self, prefixes: list[str], depth: int) -> Any:
        """Return the names that begin with one of the prefixes, down to a depth, as ListParametersResult.

        Raises TypeError: an argument is of another type. ValueError: the depth is negative.
        """
        if not isinstance(prefixes, list):
            raise TypeError("The prefixes argument must be a list")
        if not all(isinstance(prefix, str) for prefix in prefixes):
            raise TypeError("All prefixes must be instances of type str")
        if not isinstance(depth, int):
            raise TypeError("The depth must be instance of type int")
        if depth < 0:
            raise ValueError("The depth must be greater than or equal to zero")
        from rcl_interfaces.msg import ListParametersResult

        result = ListParametersResult()
        for name in self._parameters:
            if _is_listed(name, prefixes, depth):
                result.names.append(name)
                prefix = name.rpartition(PARAMETER_SEPARATOR_STRING)[0]
                if prefix and prefix not in result.prefixes:
                    result.prefixes.append(prefix)
        return result

    def add_pre_set_parameters_callback(self, callback: Callback) -> None:
        """Have `callback` return the parameters to set instead of those given."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Callback) -> None:
        """Undo `add_pre_set_parameters_callback`; ValueError when it was not added."""
        self._pre_set_parameters_callbacks.remove(callback)

    def add_post_set_parameters_callback(self, callback: Callback) -> None:
        """Have `callback` called after parameters were set or declared."""
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_post_set_parameters_callback(self, callback: Callback) -> None:
        """Undo `add_post_set_parameters_callback`; ValueError when it was not added."""
        self._post_set_parameters_callbacks.remove(callback)

    # Questions about the graph --------------------------------------------------------------------

    def get_fully_qualified_node_names(self) -> list[str]:
        """Return the full names of all nodes."""
        return [f"{space.rstrip('/')}/{name}" for name, space in self.get_node_names_and_namespaces()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Look every 0.1 s, for `timeout` seconds, whether a node exists."""
        full_name = fully_qualified_node_name
        full_name = full_name if full_name.startswith("/") else f"/{full_name}"
        end_ns = kernel.now_ns + int(timeout * S_TO_NS)
        is_there = False
        while kernel.now_ns < end_ns and not is_there:
            is_there = full_name in self.get_fully_qualified_node_names()
            kernel.sleep_ns(_POLL_NS)
        return is_there

    def count_clients(self, service_name: str) -> int:
        """Return how many clients a service has."""
        handle: Any = self._rcl_graph_handle()
        return int(handle.get_count_clients(self._rcl_full_name(service_name, is_service=True)))

    def count_services(self, service_name: str) -> int:
        """Return how many servers a service has."""
        handle: Any = self._rcl_graph_handle()
        return int(handle.get_count_services(self._rcl_full_name(service_name, is_service=True)))

    def _rcl_infos(self, topic_name: str, no_mangle: bool, *, writers: bool) -> list[TopicEndpointInfo]:
        infos: list[Any] = _humble_infos(self, topic_name, no_mangle, writers=writers)
        for info in infos:
            info.topic_type_hash = hash_of(info.topic_type)
        return infos


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    separator = PARAMETER_SEPARATOR_STRING
    if not prefixes:
        return not depth or name.count(separator) < depth
    return any(
        name == prefix
        or (
            name.startswith(prefix + separator)
            and (not depth or name[len(prefix) + 1 :].count(separator) < depth)
        )
        for prefix in prefixes
    )


def create_node(*node_name: str, enable_logger_service: bool = False, **humble: Any) -> node.Node:
    """Create a `rclpy.node.Node`; the arguments are described there."""
    if not enable_logger_service:
        return _humble_create_node(*node_name, **humble)
    import rclpy.node  # now it is there for the script, too

    new: Any = rclpy.node.Node
    created: node.Node = new(*node_name, enable_logger_service=True, **humble)
    return created


replace(node, _no_publisher_callbacks=PublisherEventCallbacks)
replace(node, _no_subscription_callbacks=SubscriptionEventCallbacks)
replace(rclpy, create_node=create_node)
