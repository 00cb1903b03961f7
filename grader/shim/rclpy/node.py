"""Nodes."""

from __future__ import annotations

from _weakref import ref

from rclpy._errors import NodeNameNonExistentError as NodeNameNonExistentError
from rclpy._forwarding import forwarding
from rclpy._handles import required
from rclpy._lazy_type import LazyType
from rclpy._node_entities import EntityMixin
from rclpy._node_graph import GraphMixin
from rclpy._node_handle import NodeHandle
from rclpy._node_parameters import ParameterMixin
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import ROSClock
from rclpy.exceptions import NotInitializedException
from rclpy.logging import get_logger
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import qos_profile_parameter_events
from rclpy.utilities import get_default_context
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

    from rclpy.callback_groups import CallbackGroup
    from rclpy.client import Client
    from rclpy.clock import Clock
    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.guard_condition import GuardCondition
    from rclpy.impl.rcutils_logger import RcutilsLogger
    from rclpy.service import Service
    from rclpy.subscription import Subscription
    from rclpy.timer import Timer
    from rclpy.waitable import Waitable

HIDDEN_NODE_PREFIX = "_"

__getattr__ = forwarding(
    __name__,
    {
        "rcl_interfaces.msg": "FloatingPointRange IntegerRange ParameterDescriptor ParameterEvent ParameterType "
        "ParameterValue SetParametersResult",
        "rclpy.callback_groups": "CallbackGroup ReentrantCallbackGroup",
        "rclpy.client": "Client",
        "rclpy.clock": "Clock",
        "rclpy.context": "Context",
        "rclpy.exceptions": "InvalidHandle InvalidParameterTypeException InvalidParameterValueException "
        "InvalidTopicNameException ParameterAlreadyDeclaredException ParameterImmutableException "
        "ParameterNotDeclaredException ParameterUninitializedException",
        "rclpy.executors": "Executor",
        "rclpy.expand_topic_name": "expand_topic_name",
        "rclpy.guard_condition": "GuardCondition",
        "rclpy.parameter": "PARAMETER_SEPARATOR_STRING",
        "rclpy.parameter_service": "ParameterService",
        "rclpy.qos": "QoSProfile qos_profile_services_default",
        "rclpy.qos_event": "PublisherEventCallbacks SubscriptionEventCallbacks",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
        "rclpy.service": "Service",
        "rclpy.subscription": "Subscription",
        "rclpy.time_source": "TimeSource",
        "rclpy.timer": "Rate Timer",
        "rclpy.topic_endpoint_info": "TopicEndpointInfo",
        "rclpy.waitable": "Waitable",
        "typing": "Any Callable Dict Iterator List Optional Sequence Tuple Type TypeVar Union",
    },
)


class Node(EntityMixin, ParameterMixin, GraphMixin):
    """A node of the ROS graph: the entry point to topics, services, timers and parameters.

    Args:
        node_name: name, without namespace.
        context: context, default the default one.
        cli_args: command-line arguments of this node only, after an implied ``--ros-args``.
        namespace: namespace of the node and its relative names.
        use_global_arguments: whether the process's ``--ros-args`` apply.
        enable_rosout: whether logs are published on /rosout.
        start_parameter_services: whether others can read and set the parameters.
        parameter_overrides: values that win over those given at declaration.
        allow_undeclared_parameters: whether parameters may be used without declaration.
        automatically_declare_parameters_from_overrides: whether overrides are declared at once.

    Raises:
        NotInitializedException: before `rclpy.init`.
        InvalidNodeNameException, InvalidNamespaceException: a name is invalid.
    """

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
    ) -> None:
        self.__handle = None
        self._context = get_default_context() if context is None else context
        EntityMixin.__init__(self)
        ParameterMixin.__init__(self, allow_undeclared_parameters)
        self._default_callback_group: CallbackGroup = MutuallyExclusiveCallbackGroup()
        self.__executor_weakref: Callable[[], Executor | None] | None = None
        if not self._context._valid():
            raise NotInitializedException("cannot create node")
        self.__node = self._create_handle(
            node_name, namespace or "", cli_args, use_global_arguments, enable_rosout
        )
        self._logger = get_logger(self.__node.logger_name())
        self._parameter_event_publisher = self._create_event_publisher()
        self._parameter_overrides = self.__node.get_parameters(Parameter)
        self._parameter_overrides.update({p.name: p for p in parameter_overrides or ()})
        self._clock = ROSClock()
        if automatically_declare_parameters_from_overrides:
            self._declare_overrides()
        self._start_services(self._clock, start_parameter_services)

    def _start_services(self, clock: ROSClock, of_parameters: bool) -> None:
        from rclpy.parameter_service import ParameterService
        from rclpy.time_source import TimeSource

        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(clock)
        if of_parameters:
            self._parameter_service = ParameterService(self)

    def _declare_overrides(self) -> None:
        from rclpy._interfaces import ParameterDescriptor

        overrides = self._parameter_overrides.items()
        self.declare_parameters(
            "", [(name, p.value, ParameterDescriptor()) for name, p in overrides], ignore_override=True
        )

    def _create_handle(
        self, name: str, namespace: str, cli_args: list[str] | None, use_global: bool, enable_rosout: bool
    ) -> NodeHandle:
        if not isinstance(name, str):
            raise TypeError(
                "__init__(): incompatible constructor arguments. The following argument types are supported:\n"
                "    1. rclpy._rclpy_pybind11.Node(arg0: str, arg1: str, arg2: rclpy._rclpy_pybind11.Context,"
                f" arg3: object, arg4: bool, arg5: bool)\n\nInvoked with: {name!r}, {namespace!r}"
            )
        try:
            return NodeHandle(
                name, namespace, required(self._context.handle), cli_args, use_global, enable_rosout
            )
        except ValueError:
            validate_node_name(name)
            if not namespace.startswith("/"):
                namespace = "/" + namespace
            validate_namespace(namespace)
            raise

    def _create_event_publisher(self) -> Publisher:
        from rclpy._endpoints import PublisherHandle

        kind = LazyType("rcl_interfaces/msg/ParameterEvent")
        qos = qos_profile_parameter_events
        impl = PublisherHandle(self.__node, kind, "/parameter_events", qos.get_c_qos_profile())
        return self._add_publisher(
            Publisher, impl, (kind, "/parameter_events", qos), None, self.default_callback_group
        )

    # What the node consists of -------------------------------------------------------------------

    @property
    def publishers(self) -> Iterator[Publisher]:
        yield from self._publishers

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        yield from self._subscriptions

    @property
    def clients(self) -> Iterator[Client]:
        yield from self._clients

    @property
    def services(self) -> Iterator[Service]:
        yield from self._services

    @property
    def timers(self) -> Iterator[Timer]:
        yield from self._timers

    @property
    def guards(self) -> Iterator[GuardCondition]:
        yield from self._guards

    @property
    def waitables(self) -> Iterator[Waitable]:
        yield from self._waitables

    @property
    def executor(self) -> Executor | None:
        """The executor the node was added to, None when there is none."""
        return None if self.__executor_weakref is None else self.__executor_weakref()

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current == new_executor:
            return
        if current is not None:
            current.remove_node(self)
        if new_executor is None:
            self.__executor_weakref = None
        else:
            new_executor.add_node(self)
            self.__executor_weakref = ref(new_executor)

    def _wake_executor(self) -> None:
        executor = self.executor
        if executor is not None:
            executor.wake()

    @property
    def context(self) -> Context:
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """Group of entities created without one."""
        return self._default_callback_group

    @property
    def handle(self) -> NodeHandle:
        return self.__node

    @handle.setter
    def handle(self, value: Any) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    def get_name(self) -> str:
        """Return the node's name."""
        return self._graph_handle().name

    def get_namespace(self) -> str:
        """Return the node's namespace."""
        return self._graph_handle().namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name."""
        return self._graph_handle().path

    def get_clock(self) -> Clock:
        """Return the node's clock, which shows ROS time."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return the node's logger."""
        return self._logger

    def destroy_node(self) -> None:
        """Destroy the node and what it consists of; a second time does nothing."""
        self._parameter_event_publisher = None
        kinds: tuple[list[Any], ...] = (
            self._publishers,
            self._subscriptions,
            self._clients,
            self._services,
            self._timers,
            self._guards,
        )
        for members in kinds:
            while members:
                self._destroy(members, members[0])
        self.__node.destroy_when_not_in_use()
        self._wake_executor()


def _name_methods_as_upstream() -> None:
    """Give the methods of the parts their names in upstream's one class: TypeErrors show them."""
    for part in Node.__mro__[1:-1]:
        for name, member in vars(part).items():
            if callable(member):
                member.__qualname__ = f"Node.{name}"


_name_methods_as_upstream()
