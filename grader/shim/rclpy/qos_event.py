"""Events of publishers and subscriptions: so far those of incompatible QoS can occur in the shim."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy._rcl.enums import NativeEnum, QosPolicyKind
from rclpy._rcl.errors import UnsupportedEventTypeError as UnsupportedEventTypeError
from rclpy._rcl.handles import Handle
from rclpy.logging import get_logger
from rclpy.qos import qos_policy_name_from_kind
from rclpy.task import await_or_execute
from rclpy.waitable import NumberOfEntities, Waitable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._rcl.endpoints import EndpointHandle
    from rclpy._rcl.wait_set import WaitSet
    from rclpy.callback_groups import CallbackGroup

    Callback = Callable[[Any], Any]

__getattr__ = passed_on(__name__)


class QoSPublisherEventType(NativeEnum):
    """Events of publishers."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2


class QoSSubscriptionEventType(NativeEnum):
    """Events of subscriptions."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3


class _Info:
    """Counters an event brings."""

    def __init__(self) -> None:
        self.total_count = 0
        self.total_count_change = 0


class QoSRequestedDeadlineMissedInfo(_Info):
    """A subscription got no message within its deadline."""


class QoSOfferedDeadlineMissedInfo(_Info):
    """A publisher published nothing within its deadline."""


class QoSLivelinessLostInfo(_Info):
    """A publisher did not tell in time that it is alive."""


class QoSMessageLostInfo(_Info):
    """Messages were lost."""


class QoSLivelinessChangedInfo:
    """Publishers came alive or not."""

    def __init__(self) -> None:
        self.alive_count = 0
        self.not_alive_count = 0
        self.alive_count_change = 0
        self.not_alive_count_change = 0


class QoSRequestedIncompatibleQoSInfo(_Info):
    """Endpoints of the other side whose QoS does not fit."""

    def __init__(self) -> None:
        super().__init__()
        self.last_policy_kind = QosPolicyKind.RMW_QOS_POLICY_INVALID


QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo

_INCOMPATIBLE = (
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS,
)
_INFOS: dict[Any, type[Any]] = {
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: QoSOfferedDeadlineMissedInfo,
    QoSPublisherEventType.RCL_PUBLISHER_LIVELINESS_LOST: QoSLivelinessLostInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: QoSRequestedDeadlineMissedInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: QoSLivelinessChangedInfo,
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST: QoSMessageLostInfo,
}


class QoSEventHandle(Handle):
    """One kind of event of one publisher or subscription.

    Attributes:
        backlog: an entry for each occurrence not yet taken.
    """

    def __init__(self, parent: EndpointHandle, event_type: Any) -> None:
        super().__init__()
        self._parent = parent
        self._event_type = event_type
        self.backlog: list[int] = []
        if event_type in _INCOMPATIBLE:
            self.backlog.extend([parent.last_policy] * parent.incompatible)
            parent.watchers.append(self.backlog)

    def take_event(self) -> Any:
        """Return what happened since the last take."""
        if self._event_type not in _INCOMPATIBLE:
            return _INFOS[self._event_type]()
        info = QoSRequestedIncompatibleQoSInfo()
        info.total_count = self._parent.incompatible
        info.total_count_change = len(self.backlog)
        info.last_policy_kind = QosPolicyKind(self._parent.last_policy or 1)
        self.backlog.clear()
        return info

    def _dispose(self) -> None:
        if self.backlog in self._parent.watchers:
            self._parent.watchers = [b for b in self._parent.watchers if b is not self.backlog]


class QoSEventHandler(Waitable):
    """Calls back when an event occurs."""

    _handle_class: type[QoSEventHandle] = QoSEventHandle

    def __init__(
        self,
        *,
        callback_group: CallbackGroup,
        callback: Callback,
        event_type: NativeEnum,
        parent_impl: EndpointHandle,
    ) -> None:
        super().__init__(callback_group)
        self.event_type = event_type
        self.callback = callback
        parent_impl.require()
        self.__event = self._handle_class(parent_impl, event_type)
        self._ready_to_take_data = False
        self._event_index: int | None = None
        self._backlogs = (self.__event.backlog,)

    def _doomed(self) -> bool:
        return self.__event.doomed

    def _poll(self) -> bool:
        self._ready_to_take_data = self._ready_to_take_data or bool(self.__event.backlog)
        return self._ready_to_take_data

    def is_ready(self, wait_set: WaitSet) -> bool:
        if self._event_index is None:
            return False
        if wait_set.is_ready("event", self._event_index):
            self._ready_to_take_data = True
        return self._ready_to_take_data

    def take_data(self) -> Any:
        if not self._ready_to_take_data:
            return None
        self._ready_to_take_data = False
        self.__event.require()
        return self.__event.take_event()

    async def execute(self, taken_data: Any) -> None:
        if taken_data:
            await await_or_execute(self.callback, taken_data)

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities(num_events=1)

    def add_to_wait_set(self, wait_set: WaitSet) -> None:
        self._event_index = wait_set.add_event(self.__event)

    def __enter__(self) -> None:
        self.__event.__enter__()

    def __exit__(self, *details: object) -> None:
        self.__event.__exit__(*details)

    def destroy(self) -> None:
        """Destroy the handle."""
        self.__event.destroy_when_not_in_use()


def _warning_of(handle: EndpointHandle, text: str) -> Callback:
    logger = get_logger(handle.get_logger_name())

    def warn(event: Any) -> None:
        logger.warn(text + qos_policy_name_from_kind(event.last_policy_kind))

    return warn


class _EventCallbacks:
    """Callbacks for events of one endpoint; without one for incompatible QoS a warning is logged."""

    _handler_class: type[QoSEventHandler] = QoSEventHandler

    def create_event_handlers(
        self, callback_group: CallbackGroup, endpoint: EndpointHandle, topic_name: str
    ) -> list[QoSEventHandler]:
        """Return the handlers of one endpoint."""
        return [
            self._handler_class(
                callback_group=callback_group, callback=callback, event_type=kind, parent_impl=endpoint
            )
            for kind, callback in self._callbacks(endpoint, topic_name)
            if callback
        ]

    def _callbacks(self, endpoint: EndpointHandle, topic_name: str) -> list[tuple[Any, Callback | None]]:
        """Return what is called for each kind of event."""
        raise NotImplementedError


class SubscriptionEventCallbacks(_EventCallbacks):
    """Callbacks for events of a subscription."""

    def __init__(
        self,
        *,
        deadline: Callback | None = None,
        incompatible_qos: Callback | None = None,
        liveliness: Callback | None = None,
        message_lost: Callback | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline = deadline
        self.incompatible_qos = incompatible_qos
        self.liveliness = liveliness
        self.message_lost = message_lost
        self.use_default_callbacks = use_default_callbacks

    def _callbacks(self, endpoint: EndpointHandle, topic_name: str) -> list[tuple[Any, Callback | None]]:
        incompatible = self.incompatible_qos
        if not incompatible and self.use_default_callbacks:
            incompatible = _warning_of(
                endpoint,
                f"New publisher discovered on topic '{topic_name}', offering incompatible QoS. "
                "No messages will be received from it. Last incompatible policy: ",
            )
        kinds = QoSSubscriptionEventType
        return [
            (kinds.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED, self.deadline),
            (kinds.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS, incompatible),
            (kinds.RCL_SUBSCRIPTION_LIVELINESS_CHANGED, self.liveliness),
            (kinds.RCL_SUBSCRIPTION_MESSAGE_LOST, self.message_lost),
        ]


class PublisherEventCallbacks(_EventCallbacks):
    """Callbacks for events of a publisher."""

    def __init__(
        self,
        *,
        deadline: Callback | None = None,
        liveliness: Callback | None = None,
        incompatible_qos: Callback | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline = deadline
        self.liveliness = liveliness
        self.incompatible_qos = incompatible_qos
        self.use_default_callbacks = use_default_callbacks

    def _callbacks(self, endpoint: EndpointHandle, topic_name: str) -> list[tuple[Any, Callback | None]]:
        incompatible = self.incompatible_qos
        if not incompatible and self.use_default_callbacks:
            incompatible = _warning_of(
                endpoint,
                f"New subscription discovered on topic '{topic_name}', requesting incompatible QoS. "
                "No messages will be sent to it. Last incompatible policy: ",
            )
        kinds = QoSPublisherEventType
        return [
            (kinds.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED, self.deadline),
            (kinds.RCL_PUBLISHER_LIVELINESS_LOST, self.liveliness),
            (kinds.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS, incompatible),
        ]
