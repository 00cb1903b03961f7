"""Publishers, subscriptions, clients and services: names, time-outs, message infos, introspection."""

from __future__ import annotations

from rclpy import client, service, subscription
from rclpy._jazzy.introspection import (
    OFF,
    REQUEST_RECEIVED,
    REQUEST_SENT,
    RESPONSE_RECEIVED,
    RESPONSE_SENT,
    Introspection,
)
from rclpy._jazzy.matching import matches_of
from rclpy._jazzy.overlay import extends
from rclpy._kernel import kernel
from rclpy._rcl import endpoints, qos, service_endpoints
from rclpy._rcl.enums import NativeEnum
from rclpy.utilities import timeout_sec_to_nsec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy.clock import Clock
    from rclpy.qos import QoSProfile

_humble_take_message = endpoints.SubscriptionHandle.take_message
_humble_publisher_init = endpoints.PublisherHandle.__init__
_humble_subscription_init = endpoints.SubscriptionHandle.__init__
_BEST_AVAILABLE = 4
_NEITHER = (
    "Subscription.__init__(): callback should be either be callable with one argument"
    "(to get only the message) or two (to get message and message info)"
)


def _settled(wanted: qos.NativeQos, writers: list[Any] | None) -> qos.NativeQos:
    """Return a profile without BEST_AVAILABLE: the most that the writers offer; for a writer the most there is."""
    if _BEST_AVAILABLE not in (wanted.reliability, wanted.durability):
        return wanted
    reliable = writers is None or all(writer.qos.reliability != qos.BEST_EFFORT for writer in writers)
    kept = writers is None or all(writer.qos.durability == qos.TRANSIENT_LOCAL for writer in writers)
    reliability = qos.RELIABLE if reliable else qos.BEST_EFFORT
    durability = qos.TRANSIENT_LOCAL if kept else qos.VOLATILE
    return qos.NativeQos(
        wanted.history,
        wanted.depth,
        reliability if wanted.reliability == _BEST_AVAILABLE else wanted.reliability,
        durability if wanted.durability == _BEST_AVAILABLE else wanted.durability,
        liveliness=qos.AUTOMATIC,
    )


@extends(endpoints.PublisherHandle)
class PublisherHandle(endpoints.PublisherHandle):
    """Writer of a topic."""

    def __init__(self, node: Any, cls: Any, name: str, profile: qos.NativeQos) -> None:
        _humble_publisher_init(self, node, cls, name, _settled(profile, None))


@extends(endpoints.SubscriptionHandle)
class SubscriptionHandle(endpoints.SubscriptionHandle):
    """Reader of a topic."""

    def __init__(self, node: Any, cls: Any, name: str, profile: qos.NativeQos) -> None:
        if _BEST_AVAILABLE in (profile.reliability, profile.durability):
            writers = node.graph.writers.at(node.expand_and_remap(name, service=False))
            profile = _settled(profile, writers)
        _humble_subscription_init(self, node, cls, name, profile)

    def take_message(self, cls: type, raw: bool) -> tuple[Any, dict[str, Any]] | None:
        """Return the oldest message (bytes when `raw`) with its info; None when there is none."""
        taken = _humble_take_message(self, cls, raw)
        if taken is None:
            return None
        self._taken = getattr(self, "_taken", 0) + 1
        numbers = {"publication_sequence_number": self._taken, "reception_sequence_number": None}
        return taken[0], {**taken[1], **numbers}

    def get_publisher_count(self) -> int:
        """Return how many publishers are matched."""
        self.node.require_context("failed to get publisher count")
        kernel.charge()
        return matches_of(self).now


@extends(subscription.Subscription)
class Subscription(subscription.Subscription):
    """Calls back with each message of a topic, and with its info if the callback takes two arguments."""

    class CallbackType(NativeEnum):
        """What a callback takes."""

        MessageOnly = 0
        WithMessageInfo = 1

    @property
    def callback(self) -> Callable[..., Any]:
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._callback = value
        import inspect

        for kind, arguments in ((self.CallbackType.MessageOnly, 1), (self.CallbackType.WithMessageInfo, 2)):
            try:
                inspect.signature(value).bind(*(object(),) * arguments)
            except TypeError:
                continue
            self._callback_type = kind
            return
        raise RuntimeError(_NEITHER)

    def get_publisher_count(self) -> int:
        """Return how many publishers are matched."""
        self.handle.require()
        return self.handle.get_publisher_count()  # type: ignore[attr-defined,no-any-return]


_humble_send_request = service_endpoints.ClientHandle.send_request
_humble_take_response = service_endpoints.ClientHandle.take_response
_humble_take_request = service_endpoints.ServiceHandle.service_take_request
_humble_send_response = service_endpoints.ServiceHandle.service_send_response


def _configure_introspection(end: Any, clock: Any, profile: qos.NativeQos, state: Any) -> None:
    """Begin, change or end the publishing of events of a client or service."""
    before = getattr(end, "_introspection", None)
    if before is not None:
        before.end()
    end._introspection = None if int(state) == OFF else Introspection(end, clock, profile, state)


def _tell(end: Any, what: int, client: Any, sequence: int, **content: Any) -> None:
    introspection = getattr(end, "_introspection", None)
    if introspection is not None:
        introspection.tell(what, client, sequence, **content)


@extends(service_endpoints.ClientHandle)
class ClientHandle(service_endpoints.ClientHandle):
    """Caller of a service."""

    configure_introspection = _configure_introspection

    @property
    def service_name(self) -> str:
        return self.name

    def send_request(self, request: Any) -> int:
        """Send a request to every matching service and return its sequence number."""
        sequence = _humble_send_request(self, request)
        _tell(self, REQUEST_SENT, self, sequence, request=request)
        return sequence

    def take_response(self, cls: type) -> tuple[service_endpoints.ServiceInfo | None, Any]:
        """Return the oldest response with its header, or two Nones."""
        header, response = _humble_take_response(self, cls)
        if header is not None:
            _tell(self, RESPONSE_RECEIVED, self, header.request_id.sequence_number, response=response)
        return header, response


@extends(service_endpoints.ServiceHandle)
class ServiceHandle(service_endpoints.ServiceHandle):
    """Server of a service."""

    configure_introspection = _configure_introspection

    def service_take_request(self, cls: type) -> tuple[Any, service_endpoints.ServiceInfo | None]:
        """Return the oldest request with its header, or two Nones."""
        request, header = _humble_take_request(self, cls)
        if header is not None:
            request_id = header.request_id
            _tell(self, REQUEST_RECEIVED, request_id.client, request_id.sequence_number, request=request)
        return request, header

    def service_send_response(self, response: Any, request_id: service_endpoints.RequestId) -> None:
        """Answer one request."""
        _humble_send_response(self, response, request_id)
        _tell(self, RESPONSE_SENT, request_id.client, request_id.sequence_number, response=response)


def _service_name(self: Any) -> str:
    self.handle.require()
    name: str = self.handle.name
    return name


def configure_introspection(
    self: Any, clock: Clock, service_event_qos_profile: QoSProfile, introspection_state: Any
) -> None:
    """Publish what this client or service sends and takes on ``<service>/_service_event``."""
    self.handle.require()
    profile = service_event_qos_profile.get_c_qos_profile()
    _configure_introspection(self.handle, clock.handle, profile, introspection_state)


@extends(client.Client)
class Client(client.Client):
    """Calls a service."""

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Call and block until the response, or return None after the time-out.

        Raises TypeError: `request` is no Request of this service.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError()
        call = f"client.call() of {self.srv_name!r}"
        if timeout_sec is None:
            return client.block_on(self.call_async(request), call)
        future = self.call_async(request)
        deadline_ns = kernel.now_ns + max(0, timeout_sec_to_nsec(timeout_sec))
        if not kernel.wait(lambda: future._done, deadline_ns, call):
            self.remove_pending_request(future)
        error = future.exception()
        if error is not None:
            raise error
        return future.result()

    service_name = property(_service_name)
    configure_introspection = configure_introspection


@extends(service.Service)
class Service(service.Service):
    """Answers requests."""

    service_name = property(_service_name)
    configure_introspection = configure_introspection
