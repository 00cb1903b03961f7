"""The part of `rclpy.node.Node` that creates and destroys what a node consists of."""

from __future__ import annotations

from rclpy._endpoints import PublisherHandle, SubscriptionHandle
from rclpy._messages import class_of
from rclpy._names import expand
from rclpy._node_destruction import DestructionMixin
from rclpy._service_endpoints import ClientHandle, ServiceHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.constants import S_TO_NS
from rclpy.exceptions import InvalidTopicNameException
from rclpy.guard_condition import GuardCondition
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_services_default
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Rate, Timer
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._node_handle import NodeHandle
    from rclpy.callback_groups import CallbackGroup
    from rclpy.clock import Clock
    from rclpy.context import Context
    from rclpy.qos_event import PublisherEventCallbacks, SubscriptionEventCallbacks
    from rclpy.qos_overriding_options import QoSOverridingOptions
    from rclpy.waitable import Waitable


class EntityMixin(DestructionMixin):
    """Creates publishers, subscriptions, timers and the rest, and destroys them."""

    _clock: Clock

    def __init__(self) -> None:
        super().__init__()
        self._rate_group = ReentrantCallbackGroup()

    @property
    def handle(self) -> NodeHandle:
        """Handle of the node."""
        raise NotImplementedError()

    @property
    def context(self) -> Context:
        raise NotImplementedError()

    @property
    def default_callback_group(self) -> CallbackGroup:
        raise NotImplementedError()

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

    def _prepare_topic(
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

            _declare_qos_parameters(kind, self, final, qos, options)  # type: ignore[arg-type]

    def add_waitable(self, waitable: Waitable) -> None:
        """Have the node's executor wait for a custom waitable."""
        self._waitables.append(waitable)
        self._wake_executor()

    def remove_waitable(self, waitable: Waitable) -> None:
        """Undo `add_waitable`."""
        self._waitables.remove(waitable)
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
        self._prepare_topic(Publisher, topic, qos_profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        impl = PublisherHandle(self.handle, class_of(msg_type), topic, qos_profile.get_c_qos_profile())
        return self._add_publisher(
            publisher_class, impl, (msg_type, topic, qos_profile), event_callbacks, group
        )

    def _add_publisher(
        self,
        publisher_class: type[Publisher],
        impl: PublisherHandle,
        identity: tuple[Any, str, QoSProfile],
        event_callbacks: PublisherEventCallbacks | None,
        group: CallbackGroup,
    ) -> Publisher:
        from rclpy.qos_event import PublisherEventCallbacks

        callbacks = event_callbacks or PublisherEventCallbacks()
        try:
            publisher = publisher_class(impl, *identity, event_callbacks=callbacks, callback_group=group)
        except Exception:
            impl.destroy_when_not_in_use()
            raise
        self._publishers.append(publisher)
        self._wake_executor()
        for handler in publisher.event_handlers:
            self.add_waitable(handler)
        return publisher

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
        from rclpy.qos_event import SubscriptionEventCallbacks

        qos_profile = self._validate_qos_or_depth_parameter(qos_profile)
        group = callback_group or self.default_callback_group
        self._prepare_topic(Subscription, topic, qos_profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        msg_type = class_of(msg_type)
        impl = SubscriptionHandle(self.handle, msg_type, topic, qos_profile.get_c_qos_profile())
        try:
            callbacks = event_callbacks or SubscriptionEventCallbacks()
            identity = (impl, msg_type, topic, callback, group, qos_profile, raw)
            subscription = Subscription(*identity, event_callbacks=callbacks)
        except Exception:
            impl.destroy_when_not_in_use()
            raise
        group.add_entity(subscription)
        self._subscriptions.append(subscription)
        self._wake_executor()
        for handler in subscription.event_handlers:
            self.add_waitable(handler)
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
        impl = self._service_endpoint(ClientHandle, srv_type, srv_name, qos_profile)
        client = Client(self.context, impl, srv_type, srv_name, qos_profile, group)
        group.add_entity(client)
        self._clients.append(client)
        self._wake_executor()
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
        return self._add_service(srv_type, srv_name, callback, qos_profile, callback_group)

    def _add_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        qos_profile: QoSProfile,
        callback_group: CallbackGroup | None,
    ) -> Service:
        group = self.default_callback_group if callback_group is None else callback_group
        impl = self._service_endpoint(ServiceHandle, srv_type, srv_name, qos_profile)
        service = Service(impl, srv_type, srv_name, callback, group, qos_profile)
        group.add_entity(service)
        self._services.append(service)
        self._wake_executor()
        return service

    def _service_endpoint(self, kind: Any, srv_type: Any, name: str, qos: QoSProfile) -> Any:
        try:
            return kind(self.handle, srv_type, name, qos.get_c_qos_profile())
        except ValueError:
            pass
        self._validate_topic_or_service_name(name, is_service=True)
        raise RuntimeError(f"failed to create service or client {name!r}")

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
    ) -> Timer:
        """Have `callback` called every period (seconds), first after one; RCLError when it is negative."""
        period_ns = int(float(timer_period_sec) * S_TO_NS)
        group = self.default_callback_group if callback_group is None else callback_group
        chosen = self._clock if clock is None else clock
        timer = Timer(callback, group, period_ns, chosen, context=self.context)
        group.add_entity(timer)
        self._timers.append(timer)
        self._wake_executor()
        return timer

    def create_guard_condition(
        self, callback: Callable[[], Any], callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """Create a guard condition: `callback` is executed after each trigger."""
        group = self.default_callback_group if callback_group is None else callback_group
        guard = GuardCondition(callback, group, context=self.context)
        group.add_entity(guard)
        self._guards.append(guard)
        self._wake_executor()
        return guard

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create a rate (in hertz) to sleep with; ValueError unless `frequency` is positive."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        return Rate(timer, context=self.context)
