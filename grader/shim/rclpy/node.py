"""Nodes."""

from __future__ import annotations

from _weakref import ref

from rclpy._forwarding import passed_on
from rclpy._interfaces.messages import class_of, interface_class
from rclpy._interfaces.own import LazyType
from rclpy._rcl.endpoints import PublisherHandle, SubscriptionHandle
from rclpy._rcl.errors import NodeNameNonExistentError as NodeNameNonExistentError
from rclpy._rcl.errors import RCLError, text_or_null, wrong_arguments
from rclpy._rcl.handles import changes, required
from rclpy._rcl.names import expand
from rclpy._rcl.node_handle import NodeHandle
from rclpy._rcl.parameter_rules import check_descriptor, check_descriptors, named_declaration
from rclpy._rcl.rosout import open_rosout
from rclpy._rcl.service_endpoints import ClientHandle, ServiceHandle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.clock import ROSClock
from rclpy.constants import S_TO_NS
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    InvalidTopicNameException,
    NotInitializedException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.guard_condition import GuardCondition
from rclpy.logging import get_logger
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Rate, Timer
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.utilities import get_default_context
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from typing import Any, Protocol

    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.context import Context
    from rclpy.impl.rcutils_logger import RcutilsLogger
    from rclpy.qos_event import PublisherEventCallbacks, SubscriptionEventCallbacks
    from rclpy.qos_overriding_options import QoSOverridingOptions
    from rclpy.topic_endpoint_info import TopicEndpointInfo
    from rclpy.waitable import Waitable

    NamesAndTypes = list[tuple[str, list[str]]]
    SetCallback = Callable[[list[Parameter]], Any]

    class Executor(Protocol):
        """What a node needs of its executor; importing `rclpy.executors` for it would close a circle."""

        def add_node(self, node: Node) -> bool:
            """Serve the node."""

        def remove_node(self, node: Node) -> None:
            """Stop serving the node."""

        def wake(self) -> None:
            """Have a blocked wait look again."""

        def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
            """Have a function or coroutine function run."""


HIDDEN_NODE_PREFIX = "_"
NOT_SET = Parameter.Type.NOT_SET
_INTEGERS = (Parameter.Type.INTEGER, Parameter.Type.INTEGER_ARRAY)
_GID_BYTES = 24

__getattr__ = passed_on(__name__)


class Node:
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

    PARAM_REL_TOL = 1e-6
    """Relative tolerance when a float parameter is held against its range."""

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
        self._context = get_default_context() if context is None else context
        self._rcl_start_without_entities()
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._parameters_callbacks: list[SetCallback] = []
        self._allow_undeclared_parameters = allow_undeclared_parameters
        self._default_callback_group: CallbackGroup = MutuallyExclusiveCallbackGroup()
        self.__executor_weakref: Callable[[], Executor | None] | None = None
        if not self._context._valid():
            raise NotInitializedException("cannot create node")
        self.__node = self._rcl_create_handle(
            node_name, namespace or "", cli_args, use_global_arguments, enable_rosout
        )
        with self.handle:  # a script's own method of that name fails here, as at home
            self._logger = get_logger(self.__node.logger_name())
        self._parameter_event_publisher: Publisher | None = self._rcl_create_event_publisher()
        self._parameter_overrides = self.__node.get_parameters(Parameter)
        self._parameter_overrides.update({p.name: p for p in parameter_overrides or ()})
        self._clock = ROSClock()
        if automatically_declare_parameters_from_overrides:
            self._rcl_declare_overrides()
        self._rcl_start_services(self._clock, start_parameter_services)
        entities = (self._publishers, self._subscriptions, self._clients, self._services, self._timers)
        self.__node.leave_with(self, entities)

    def _rcl_start_without_entities(self) -> None:
        self._publishers: list[Publisher] = []
        self._subscriptions: list[Subscription] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._timers: list[Timer] = []
        self._guards: list[GuardCondition] = []
        self._rcl_waitables: list[Waitable] = []
        self._rate_group = ReentrantCallbackGroup()

    def _rcl_start_services(self, clock: ROSClock, of_parameters: bool) -> None:
        from rclpy.parameter_service import ParameterService
        from rclpy.time_source import TimeSource

        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(clock)
        if of_parameters:
            self._parameter_service = ParameterService(self)

    def _rcl_declare_overrides(self) -> None:
        from rclpy._interfaces.own import ParameterDescriptor

        overrides = self._parameter_overrides.items()
        self.declare_parameters(
            "", [(name, p.value, ParameterDescriptor()) for name, p in overrides], ignore_override=True
        )

    def _rcl_create_handle(
        self, name: str, namespace: str, cli_args: list[str] | None, use_global: bool, enable_rosout: bool
    ) -> NodeHandle:
        context = required(self._context.handle)

        def refusal() -> TypeError:
            kind = "rclpy._rclpy_pybind11"
            taken = f"arg0: str, arg1: str, arg2: {kind}.Context, arg3: object, arg4: bool, arg5: bool"
            arguments = (name, namespace, context, cli_args, use_global, enable_rosout)
            return wrong_arguments("__init__", f"{kind}.Node({taken})", *arguments)

        text, space = text_or_null(name, refusal), text_or_null(namespace, refusal)
        if text is None:
            raise RCLError("error creating node: name argument is null, at ./src/rcl/node.c:136")
        try:
            handle = NodeHandle(text, space or "", context, cli_args, use_global)
        except ValueError:
            validate_node_name(name)
            if not namespace.startswith("/"):
                namespace = "/" + namespace
            validate_namespace(namespace)
            raise
        open_rosout(handle, enabled=enable_rosout)
        return handle

    def _rcl_create_event_publisher(self) -> Publisher:
        qos = qos_profile_parameter_events
        if type(self).create_publisher is not Node.create_publisher:
            # A script has a method of that name, which upstream calls here.
            from rclpy._interfaces.own import ParameterEvent

            return self.create_publisher(ParameterEvent, "/parameter_events", qos)
        kind = LazyType("rcl_interfaces/msg/ParameterEvent")
        impl = PublisherHandle(self.__node, kind, "/parameter_events", qos.get_c_qos_profile())
        return self._rcl_add_publisher(
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
        yield from self._rcl_waitables

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

    def _wake_executor(self, *, added: bool = False) -> None:
        """Have the executor look again: the node has gained an entity (`added`) or lost one."""
        changes.count += 1
        changes.additions += added
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
        return self._rcl_graph_handle().name

    def get_namespace(self) -> str:
        """Return the node's namespace."""
        return self._rcl_graph_handle().namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name."""
        return self._rcl_graph_handle().path

    def get_clock(self) -> Clock:
        """Return the node's clock, which shows ROS time."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return the node's logger."""
        return self._logger

    # Entities -------------------------------------------------------------------------------------

    def _validate_topic_or_service_name(self, name: str, *, is_service: bool = False) -> None:
        handle = self.handle
        validate_node_name(handle.name)
        validate_namespace(handle.namespace)
        validate_topic_name(name, is_service=is_service)
        full = expand(name, handle.name, handle.namespace)
        validate_full_topic_name(full, is_service=is_service)

    def _validate_qos_or_depth_parameter(self, qos_or_depth: QoSProfile | int) -> QoSProfile:
        if isinstance(qos_or_depth, QoSProfile):
            return qos_or_depth
        if not isinstance(qos_or_depth, int):
            raise TypeError(f"Expected QoSProfile or int, but received {type(qos_or_depth)!r}")
        if qos_or_depth < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos_or_depth)

    def _rcl_prepare_topic(
        self,
        kind: type[Publisher] | type[Subscription],
        topic: str,
        qos: QoSProfile,
        options: QoSOverridingOptions | None,
    ) -> None:
        """Check the name as upstream does, exceptions included, and let parameters override the QoS."""
        self.handle.require()
        try:
            final = self.handle.resolve(topic, False, False)
        except RuntimeError:
            try:
                self._validate_topic_or_service_name(topic)
            except InvalidTopicNameException as error:
                raise error from None
            raise
        if options is not None:
            from rclpy.qos_overriding_options import _declare_qos_parameters

            _declare_qos_parameters(kind, self, final, qos, options)

    def add_waitable(self, waitable: Waitable) -> None:
        """Have the node's executor wait for a custom waitable."""
        self._rcl_waitables.append(waitable)
        self._wake_executor(added=True)

    def remove_waitable(self, waitable: Waitable) -> None:
        """Undo `add_waitable`."""
        self._rcl_waitables.remove(waitable)
        self._wake_executor()

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Publisher:
        """Create a publisher.

        Args:
            msg_type: class of its messages.
            topic: name, made absolute and remapped.
            qos_profile: profile, or depth of a reliable KEEP_LAST history.
            callback_group: of its event handlers.
            event_callbacks: for events of QoS.
            qos_overriding_options: which settings parameters may change.
            publisher_class: class of the result.

        Raises:
            InvalidTopicNameException: the name is invalid. TypeError, ValueError: the profile is.
        """
        qos_profile = self._validate_qos_or_depth_parameter(qos_profile)
        group = callback_group or self.default_callback_group
        self._rcl_prepare_topic(Publisher, topic, qos_profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        impl = PublisherHandle(self.handle, class_of(msg_type), topic, qos_profile.get_c_qos_profile())
        return self._rcl_add_publisher(
            publisher_class, impl, (msg_type, topic, qos_profile), event_callbacks, group
        )

    def _rcl_add_publisher(
        self,
        publisher_class: type[Publisher],
        impl: PublisherHandle,
        identity: tuple[Any, str, QoSProfile],
        event_callbacks: PublisherEventCallbacks | None,
        group: CallbackGroup,
    ) -> Publisher:
        callbacks = event_callbacks or _no_publisher_callbacks()
        try:
            publisher = publisher_class(impl, *identity, event_callbacks=callbacks, callback_group=group)
        except Exception:
            impl.destroy_when_not_in_use()
            raise
        self._rcl_add(self._publishers, publisher)
        return publisher

    def _rcl_add(self, members: list[Any], entity: Any, group: CallbackGroup | None = None) -> None:
        if group is not None:
            group.add_entity(entity)
        members.append(entity)
        self._wake_executor(added=True)
        for handler in getattr(entity, "event_handlers", ()):
            self.add_waitable(handler)

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription:
        """Create a subscription; `callback` gets each message (bytes when `raw`). Raises as a publisher."""
        qos_profile = self._validate_qos_or_depth_parameter(qos_profile)
        group = callback_group or self.default_callback_group
        self._rcl_prepare_topic(Subscription, topic, qos_profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        msg_type = class_of(msg_type)
        impl = SubscriptionHandle(self.handle, msg_type, topic, qos_profile.get_c_qos_profile())
        try:
            callbacks = event_callbacks or _no_subscription_callbacks()
            identity = (impl, msg_type, topic, callback, group, qos_profile, raw)
            subscription = Subscription(*identity, event_callbacks=callbacks)
        except Exception:
            impl.destroy_when_not_in_use()
            raise
        self._rcl_add(self._subscriptions, subscription, group)
        return subscription

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """Create a client of a service; InvalidServiceNameException when the name is invalid."""
        group = self.default_callback_group if callback_group is None else callback_group
        check_is_valid_srv_type(srv_type)
        impl = self._rcl_service_endpoint(ClientHandle, srv_type, srv_name, qos_profile)
        client = Client(self.context, impl, srv_type, srv_name, qos_profile, group)
        self._rcl_add(self._clients, client, group)
        return client

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """Offer a service: `callback` gets request and response and returns the response."""
        check_is_valid_srv_type(srv_type)
        return self._rcl_add_service(srv_type, srv_name, callback, qos_profile, callback_group)

    def _rcl_add_own_service(
        self, kind: LazyType, name: str, callback: Callable[[Any, Any], Any], qos: QoSProfile
    ) -> None:
        """Offer a service of the library's own: by a script's `create_service`, where it has one, as upstream."""
        if type(self).create_service is Node.create_service:
            self._rcl_add_service(kind, name, callback, qos, None)
        else:
            self.create_service(interface_class(kind.full_name), name, callback, qos_profile=qos)

    def _rcl_add_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        qos_profile: QoSProfile,
        callback_group: CallbackGroup | None,
    ) -> Service:
        group = self.default_callback_group if callback_group is None else callback_group
        impl = self._rcl_service_endpoint(ServiceHandle, srv_type, srv_name, qos_profile)
        service = Service(impl, srv_type, srv_name, callback, group, qos_profile)
        self._rcl_add(self._services, service, group)
        return service

    def _rcl_service_endpoint(self, kind: Any, srv_type: Any, name: str, qos: QoSProfile) -> Any:
        if not isinstance(name, str):
            name = self._rcl_service_name(kind, srv_type, name, qos)
        try:
            return kind(self.handle, srv_type, name, qos.get_c_qos_profile())
        except ValueError:
            pass
        self._validate_topic_or_service_name(name, is_service=True)
        raise RuntimeError(f"failed to create service or client {name!r}")

    def _rcl_service_name(self, kind: Any, srv_type: Any, name: Any, qos: QoSProfile) -> str:
        """Take what is no text as C does: of a client, None is a null pointer, and bytes are a text."""
        shown = (self.handle, srv_type, name, qos.get_c_qos_profile())
        what = kind.what.capitalize()
        signature = f"rclpy._rclpy_pybind11.{what}(arg0: rclpy::Node, arg1: object, arg2: str, arg3: object)"
        refusal = wrong_arguments("__init__", signature, *shown)
        text = text_or_null(name, lambda: refusal)
        if text is None:
            if kind is ServiceHandle:  # it takes a C++ string
                raise refusal
            raise RCLError("failed to create client: service_name argument is null, at ./src/rcl/client.c:71")
        return text

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
    ) -> Timer:
        """Have `callback` called every period (seconds), first after one; RCLError when it is negative."""
        return self._rcl_add_timer(timer_period_sec, callback, callback_group, clock)

    def _rcl_add_timer(
        self, period_s: float, callback: Any, group: CallbackGroup | None, clock: Clock | None, **options: Any
    ) -> Timer:
        period_ns = int(float(period_s) * S_TO_NS)
        group = self.default_callback_group if group is None else group
        chosen = self._clock if clock is None else clock
        timer = Timer(callback, group, period_ns, chosen, context=self.context, **options)
        self._rcl_add(self._timers, timer, group)
        return timer

    def create_guard_condition(
        self, callback: Callable[[], Any], callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """Create a guard condition: `callback` is executed after each trigger."""
        group = self.default_callback_group if callback_group is None else callback_group
        guard = GuardCondition(callback, group, context=self.context)
        self._rcl_add(self._guards, guard, group)
        return guard

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create a rate (in hertz) to sleep with; ValueError unless `frequency` is positive."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        return Rate(timer, context=self.context)

    # Destruction ----------------------------------------------------------------------------------

    def _rcl_destroy(self, members: list[Any], entity: Any) -> bool:
        if entity not in members:
            return False
        members.remove(entity)
        for handler in getattr(entity, "event_handlers", ()):
            self._rcl_waitables.remove(handler)
        entity.destroy()
        self._wake_executor()
        return True

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroy a publisher of this node; whether it was one."""
        return self._rcl_destroy(self._publishers, publisher)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy a subscription of this node; whether it was one."""
        return self._rcl_destroy(self._subscriptions, subscription)

    def destroy_client(self, client: Client) -> bool:
        """Destroy a client of this node; whether it was one."""
        return self._rcl_destroy(self._clients, client)

    def destroy_service(self, service: Service) -> bool:
        """Destroy a service of this node; whether it was one."""
        return self._rcl_destroy(self._services, service)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer of this node; whether it was one."""
        return self._rcl_destroy(self._timers, timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy a guard condition of this node; whether it was one."""
        return self._rcl_destroy(self._guards, guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate of this node and wake its sleepers; whether it was one."""
        success = self.destroy_timer(rate._timer)
        rate.destroy()
        return success

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
                self._rcl_destroy(members, members[0])
        self.__node.destroy_when_not_in_use()
        self._wake_executor()

    # Declaring -----------------------------------------------------------------------------------

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare a parameter and return it with its value from the command line, or else `value`.

        Raises:
            ParameterAlreadyDeclaredException: it is declared. InvalidParameterException: its name is empty.
            InvalidParameterValueException: a callback or the descriptor rejects the value.
            InvalidParameterTypeException: the command line gives it another type.
        """
        if value is None and descriptor is None:
            declaration: tuple[Any, ...] = (name,)
        elif descriptor is None:
            from rclpy._interfaces.own import ParameterDescriptor

            declaration = (name, value, ParameterDescriptor())
        else:
            declaration = (name, value, descriptor)
        return self.declare_parameters("", [declaration], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare parameters given as (name), (name, value or type) or (name, value, descriptor).

        Raises:
            TypeError: an entry has another form.
            ValueError: a type is given together with dynamic typing, or is NOT_SET.
        """
        declared: list[Parameter] = []
        descriptors: dict[str, Any] = {}
        overrides = {} if ignore_override else self._parameter_overrides
        for index, entry in enumerate(parameters):
            name, value, descriptor = named_declaration(index, entry, namespace, overrides)
            declared.append(Parameter(name, value=value))
            descriptors[name] = descriptor
        already = [parameter.name for parameter in declared if parameter.name in self._parameters]
        if any(already):
            raise ParameterAlreadyDeclaredException(already)
        self._set_parameters(declared, descriptors, raise_on_failure=True, allow_undeclared_parameters=True)
        return [self._parameters[parameter.name] for parameter in declared]

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter; ParameterNotDeclaredException, ParameterImmutableException."""
        if not self.has_parameter(name):
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        del self._descriptors[name]

    # Reading -------------------------------------------------------------------------------------

    def has_parameter(self, name: str) -> bool:
        """Whether a parameter is declared."""
        return name in self._parameters

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Return the types of parameters; see `get_parameter_type`."""
        _require_names(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameter_type(self, name: str) -> Any:
        """Return the number of a parameter's type; ParameterNotDeclaredException."""
        if self.has_parameter(name):
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return parameters; see `get_parameter`."""
        _require_names(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; ParameterNotDeclaredException, ParameterUninitializedException."""
        if self.has_parameter(name):
            parameter = self._parameters[name]
            if parameter.type_ != NOT_SET or self._descriptors[name].dynamic_typing:
                return parameter
            raise ParameterUninitializedException(name)
        if self._allow_undeclared_parameters:
            return Parameter(name, NOT_SET, None)
        raise ParameterNotDeclaredException(name)

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative when it is not declared or has no value."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.type_ == NOT_SET:
            return Parameter(name, NOT_SET) if alternative_value is None else alternative_value
        return parameter

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters whose names begin with ``prefix.``, by the rest of their names."""
        if prefix:
            prefix = prefix + PARAMETER_SEPARATOR_STRING
        return {
            name[len(prefix) :]: parameter
            for name, parameter in self._parameters.items()
            if name.startswith(prefix)
        }

    # Setting -------------------------------------------------------------------------------------

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Set parameters one by one and return a SetParametersResult for each."""
        return self._set_parameters(parameter_list)

    def _set_parameters(
        self,
        parameter_list: list[Parameter],
        descriptors: Mapping[str, Any] | None = None,
        raise_on_failure: bool = False,
        allow_undeclared_parameters: bool = False,
    ) -> list[Any]:
        results = []
        for parameter in parameter_list:
            if not allow_undeclared_parameters:
                self._check_undeclared_parameters([parameter])
            result = self._set_parameters_atomically(
                [parameter], descriptors, allow_not_set_type=allow_undeclared_parameters
            )
            if raise_on_failure and not result.successful:
                if descriptors is not None and result.reason.startswith("Wrong parameter type"):
                    expected = Parameter.Type(descriptors[parameter.name].type).name
                    raise InvalidParameterTypeException(parameter, expected)
                raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
            results.append(result)
        return results

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none and return one SetParametersResult."""
        self._check_undeclared_parameters(parameter_list)
        return self._set_parameters_atomically(parameter_list)

    def _check_undeclared_parameters(self, parameter_list: list[Parameter]) -> None:
        if not all(isinstance(parameter, Parameter) for parameter in parameter_list):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        undeclared = (p.name for p in parameter_list if p.name not in self._parameters)
        if not self._allow_undeclared_parameters and any(undeclared):
            # Upstream names what is left of the generator after `any`: usually nothing.
            raise ParameterNotDeclaredException(list(undeclared))

    def _set_parameters_atomically(
        self,
        parameter_list: list[Parameter],
        descriptors: Mapping[str, Any] | None = None,
        allow_not_set_type: bool = False,
    ) -> Any:
        """Check, ask the callbacks, store and publish the change; NOT_SET undeclares unless allowed."""
        result = check_descriptors(
            parameter_list,
            self._descriptors if descriptors is None else descriptors,
            self._parameters,
            check_read_only=descriptors is None,
        )
        if not result.successful:
            return result
        for callback in self._parameters_callbacks:
            result = callback(parameter_list)
            if not result.successful:
                return result
        self._rcl_graph_handle()  # upstream asks for the node's name here: a destroyed one stores nothing any more
        event: dict[str, list[Parameter]] = {"new": [], "changed": [], "deleted": []}
        for parameter in parameter_list:
            event[self._rcl_store(parameter, descriptors, allow_not_set_type)].append(parameter)
        self._rcl_publish_parameter_event(event)
        from rclpy._interfaces.own import SetParametersResult

        return SetParametersResult(successful=True)

    def _rcl_store(
        self, parameter: Parameter, descriptors: Mapping[str, Any] | None, allow_not_set_type: bool
    ) -> str:
        """Store one parameter and return what happened to it."""
        name = parameter.name
        if parameter.type_ == NOT_SET and not allow_not_set_type:
            self._parameters.pop(name, None)
            self._descriptors.pop(name, None)
            return "deleted"
        if descriptors is not None:
            self._descriptors[name] = descriptors[name]
        elif name not in self._descriptors:
            from rclpy._interfaces.own import ParameterDescriptor

            self._descriptors[name] = ParameterDescriptor(dynamic_typing=True)
        old = self._parameters.get(name)
        if parameter.type_ in _INTEGERS and not _fits(parameter.value):
            parameter.to_parameter_msg()  # where upstream makes the message for all, and Humble's refuses
        self._parameters[name] = parameter
        return "new" if old is None or old.type_ == NOT_SET else "changed"

    def _rcl_publish_parameter_event(self, event: dict[str, list[Parameter]]) -> None:
        publisher = self._parameter_event_publisher
        if publisher is None or not (publisher.handle.is_heard or not self.__node.context.valid):
            return  # nobody listens, and publishing would not fail: building the message is the costly part
        from rclpy._interfaces.own import ParameterEvent

        message = ParameterEvent(node=self.get_fully_qualified_name())
        for what, parameters in event.items():
            setattr(message, f"{what}_parameters", [parameter.to_parameter_msg() for parameter in parameters])
        message.stamp = self.get_clock().now().to_msg()
        publisher.publish(message)

    def add_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Have `callback` asked before parameters are set; the last added is asked first."""
        self._parameters_callbacks.insert(0, callback)

    def remove_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Undo `add_on_set_parameters_callback`; ValueError when it was not added."""
        self._parameters_callbacks.remove(callback)

    # Descriptors of parameters --------------------------------------------------------------------

    def _apply_descriptor(
        self, parameter: Parameter, descriptor: Any = None, check_read_only: bool = True
    ) -> Any:
        if descriptor is None:
            descriptor = self.describe_parameter(parameter.name)
        return check_descriptor(parameter, descriptor, self._parameters, check_read_only)

    def describe_parameter(self, name: str) -> Any:
        """Return a parameter's ParameterDescriptor; ParameterNotDeclaredException."""
        if name in self._descriptors:
            return self._descriptors[name]
        if not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(name)
        from rclpy._interfaces.own import ParameterDescriptor

        return ParameterDescriptor()

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """Return the descriptors of parameters; see `describe_parameter`."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Give a parameter another descriptor and return its ParameterValue.

        Raises:
            ParameterNotDeclaredException: it is not declared. ParameterImmutableException: it is read-only.
            InvalidParameterValueException: neither its value nor the alternative fits.
        """
        if name not in self._parameters:
            if not self._allow_undeclared_parameters:
                raise ParameterNotDeclaredException(name)
            return self._rcl_value_message(name)
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        candidates = [self._parameters[name]]
        if alternative_value is not None:
            from rclpy._interfaces.own import Parameter as ParameterMsg

            message = ParameterMsg(name=name, value=alternative_value)
            candidates.append(Parameter.from_parameter_msg(message))
        for candidate in candidates:
            result = self._apply_descriptor(candidate, descriptor, False)
            if result.successful:
                self._parameters[name] = candidate
                self._descriptors[name] = descriptor
                return self._rcl_value_message(name)
        raise InvalidParameterValueException(name, candidates[-1].value, result.reason)

    def _rcl_value_message(self, name: str) -> Any:
        parameter = self._parameters.get(name) or Parameter(name, Parameter.Type.NOT_SET)
        return parameter.get_parameter_value()

    # Questions about the graph --------------------------------------------------------------------

    def _rcl_graph_handle(self) -> NodeHandle:
        handle = self.handle
        handle.require()
        return handle

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic name made absolute and, unless `only_expand`, remapped; RCLError when invalid."""
        return self._rcl_graph_handle().resolve(topic, only_expand, False)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return a service name made absolute and, unless `only_expand`, remapped; RCLError when invalid."""
        return self._rcl_graph_handle().resolve(service, only_expand, True)

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics a node publishes; NodeNameNonExistentError."""
        handle = self._rcl_graph_handle()
        failure = "failed to get publisher names and types"
        return handle.names_and_types_by_node(failure, handle.graph.writers, node_name, node_namespace)

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics a node listens to; NodeNameNonExistentError."""
        handle = self._rcl_graph_handle()
        failure = "failed to get subscriber names and types"
        return handle.names_and_types_by_node(failure, handle.graph.readers, node_name, node_namespace)

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services a node offers; NodeNameNonExistentError."""
        handle = self._rcl_graph_handle()
        failure = "failed to get service names and types"
        return handle.names_and_types_by_node(failure, handle.graph.servers, node_name, node_namespace)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services a node has clients of; NodeNameNonExistentError."""
        handle = self._rcl_graph_handle()
        failure = "failed to get client names and types"
        return handle.names_and_types_by_node(failure, handle.graph.clients, node_name, node_namespace)

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """Return all topics with their types."""
        handle = self._rcl_graph_handle()
        failure = "failed to get topic names and types"
        return handle.names_and_types(failure, handle.graph.writers, handle.graph.readers)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """Return all services with their types."""
        handle = self._rcl_graph_handle()
        return handle.names_and_types("failed to get service names and types", handle.graph.servers)

    def get_node_names(self) -> list[str]:
        """Return the names of all nodes."""
        return [name for name, _ in self._rcl_graph_handle().get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return the names and namespaces of all nodes."""
        return self._rcl_graph_handle().get_node_names_and_namespaces()

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return the names, namespaces and security enclaves of all nodes."""
        return self._rcl_graph_handle().get_node_names_and_namespaces_with_enclaves()

    def _rcl_full_name(self, name: str, *, is_service: bool = False) -> str:
        handle = self._rcl_graph_handle()
        full = expand(name, handle.name, handle.namespace)
        validate_full_topic_name(full, is_service=is_service)
        return full

    def count_publishers(self, topic_name: str) -> int:
        """Return how many publishers a topic has."""
        return self._rcl_graph_handle().get_count_publishers(self._rcl_full_name(topic_name))

    def count_subscribers(self, topic_name: str) -> int:
        """Return how many subscriptions a topic has."""
        return self._rcl_graph_handle().get_count_subscribers(self._rcl_full_name(topic_name))

    def _rcl_infos(self, topic_name: str, no_mangle: bool, *, writers: bool) -> list[TopicEndpointInfo]:
        from rclpy.topic_endpoint_info import TopicEndpointInfo

        handle = self._rcl_graph_handle()
        name = topic_name
        if not no_mangle:
            name = handle.remap(self._rcl_full_name(topic_name), "topic")
        what = "publishers" if writers else "subscriptions"
        handle.require_context(f"Failed to get information by topic for {what}")
        kind = handle.graph.writers if writers else handle.graph.readers
        return [
            TopicEndpointInfo(
                node_name=endpoint.owner[0],
                node_namespace=endpoint.owner[1],
                topic_type=endpoint.type_name,
                endpoint_type=1 if writers else 2,
                endpoint_gid=list(endpoint.gid.to_bytes(_GID_BYTES, "big")),
                qos_profile=endpoint.qos.discovered(writer=writers),
            )
            for endpoint in kind.at(name)
        ]

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Return what is known of a topic's publishers."""
        return self._rcl_infos(topic_name, no_mangle, writers=True)

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Return what is known of a topic's subscriptions."""
        return self._rcl_infos(topic_name, no_mangle, writers=False)


def _no_publisher_callbacks() -> PublisherEventCallbacks:
    from rclpy.qos_event import PublisherEventCallbacks

    return PublisherEventCallbacks()


def _no_subscription_callbacks() -> SubscriptionEventCallbacks:
    from rclpy.qos_event import SubscriptionEventCallbacks

    return SubscriptionEventCallbacks()


def _fits(value: Any) -> bool:
    """Whether an integer, or each of several, has 64 bits."""
    return all(-(2**63) <= each < 2**63 for each in (value if hasattr(value, "__iter__") else (value,)))


def _require_names(names: list[str]) -> None:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")
